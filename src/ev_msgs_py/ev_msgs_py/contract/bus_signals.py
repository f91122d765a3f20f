"""Frames of a CAN bus as signals: each payload as two words of 32 bits, which a float64 holds exactly; -1: no frame.

A period has a place for each tick of 1 ms, of which the first ones are used; what comes less often has one place.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ev_msgs_py.contract.fields import Field

MOST_TICKS = 5  # of 1 ms, in a control period


def _low(frame: str) -> Field:
    return Field("1", "bits 0 to 31 of the payload", f"{frame}.position")


def _high(frame: str) -> Field:
    return Field("1", "bits 32 to 63 of the payload", f"{frame}.velocity")


class SetPointFrames(NamedTuple):
    """What the controller puts on the bus in the ticks from this instant on."""

    drive_11_0_low: Annotated[float, _low("drive_11_set_point_0")]
    drive_11_0_high: Annotated[float, _high("drive_11_set_point_0")]
    drive_11_1_low: Annotated[float, _low("drive_11_set_point_1")]
    drive_11_1_high: Annotated[float, _high("drive_11_set_point_1")]
    drive_11_2_low: Annotated[float, _low("drive_11_set_point_2")]
    drive_11_2_high: Annotated[float, _high("drive_11_set_point_2")]
    drive_11_3_low: Annotated[float, _low("drive_11_set_point_3")]
    drive_11_3_high: Annotated[float, _high("drive_11_set_point_3")]
    drive_11_4_low: Annotated[float, _low("drive_11_set_point_4")]
    drive_11_4_high: Annotated[float, _high("drive_11_set_point_4")]
    drive_12_0_low: Annotated[float, _low("drive_12_set_point_0")]
    drive_12_0_high: Annotated[float, _high("drive_12_set_point_0")]
    drive_12_1_low: Annotated[float, _low("drive_12_set_point_1")]
    drive_12_1_high: Annotated[float, _high("drive_12_set_point_1")]
    drive_12_2_low: Annotated[float, _low("drive_12_set_point_2")]
    drive_12_2_high: Annotated[float, _high("drive_12_set_point_2")]
    drive_12_3_low: Annotated[float, _low("drive_12_set_point_3")]
    drive_12_3_high: Annotated[float, _high("drive_12_set_point_3")]
    drive_12_4_low: Annotated[float, _low("drive_12_set_point_4")]
    drive_12_4_high: Annotated[float, _high("drive_12_set_point_4")]
    heartbeat_11: Annotated[float, _low("heartbeat_11")]
    heartbeat_12: Annotated[float, _low("heartbeat_12")]
    load_11_0_low: Annotated[float, _low("load_11_set_point_0")]
    load_11_0_high: Annotated[float, _high("load_11_set_point_0")]
    load_11_1_low: Annotated[float, _low("load_11_set_point_1")]
    load_11_1_high: Annotated[float, _high("load_11_set_point_1")]
    load_11_2_low: Annotated[float, _low("load_11_set_point_2")]
    load_11_2_high: Annotated[float, _high("load_11_set_point_2")]
    load_11_3_low: Annotated[float, _low("load_11_set_point_3")]
    load_11_3_high: Annotated[float, _high("load_11_set_point_3")]
    load_11_4_low: Annotated[float, _low("load_11_set_point_4")]
    load_11_4_high: Annotated[float, _high("load_11_set_point_4")]
    load_12_0_low: Annotated[float, _low("load_12_set_point_0")]
    load_12_0_high: Annotated[float, _high("load_12_set_point_0")]
    load_12_1_low: Annotated[float, _low("load_12_set_point_1")]
    load_12_1_high: Annotated[float, _high("load_12_set_point_1")]
    load_12_2_low: Annotated[float, _low("load_12_set_point_2")]
    load_12_2_high: Annotated[float, _high("load_12_set_point_2")]
    load_12_3_low: Annotated[float, _low("load_12_set_point_3")]
    load_12_3_high: Annotated[float, _high("load_12_set_point_3")]
    load_12_4_low: Annotated[float, _low("load_12_set_point_4")]
    load_12_4_high: Annotated[float, _high("load_12_set_point_4")]


class FeedbackFrames(NamedTuple):
    """What has arrived at the controller in the ticks before this instant."""

    drive_11_motion_0_low: Annotated[float, _low("drive_11_motion_0")]
    drive_11_motion_0_high: Annotated[float, _high("drive_11_motion_0")]
    drive_11_motion_1_low: Annotated[float, _low("drive_11_motion_1")]
    drive_11_motion_1_high: Annotated[float, _high("drive_11_motion_1")]
    drive_11_motion_2_low: Annotated[float, _low("drive_11_motion_2")]
    drive_11_motion_2_high: Annotated[float, _high("drive_11_motion_2")]
    drive_11_motion_3_low: Annotated[float, _low("drive_11_motion_3")]
    drive_11_motion_3_high: Annotated[float, _high("drive_11_motion_3")]
    drive_11_motion_4_low: Annotated[float, _low("drive_11_motion_4")]
    drive_11_motion_4_high: Annotated[float, _high("drive_11_motion_4")]
    drive_11_electrical_low: Annotated[float, _low("drive_11_electrical")]
    drive_11_electrical_high: Annotated[float, _high("drive_11_electrical")]
    drive_11_temperatures_low: Annotated[float, _low("drive_11_temperatures")]
    drive_11_temperatures_high: Annotated[float, _high("drive_11_temperatures")]
    drive_11_faults_low: Annotated[float, _low("drive_11_faults")]
    drive_11_faults_high: Annotated[float, _high("drive_11_faults")]
    drive_12_motion_0_low: Annotated[float, _low("drive_12_motion_0")]
    drive_12_motion_0_high: Annotated[float, _high("drive_12_motion_0")]
    drive_12_motion_1_low: Annotated[float, _low("drive_12_motion_1")]
    drive_12_motion_1_high: Annotated[float, _high("drive_12_motion_1")]
    drive_12_motion_2_low: Annotated[float, _low("drive_12_motion_2")]
    drive_12_motion_2_high: Annotated[float, _high("drive_12_motion_2")]
    drive_12_motion_3_low: Annotated[float, _low("drive_12_motion_3")]
    drive_12_motion_3_high: Annotated[float, _high("drive_12_motion_3")]
    drive_12_motion_4_low: Annotated[float, _low("drive_12_motion_4")]
    drive_12_motion_4_high: Annotated[float, _high("drive_12_motion_4")]
    drive_12_electrical_low: Annotated[float, _low("drive_12_electrical")]
    drive_12_electrical_high: Annotated[float, _high("drive_12_electrical")]
    drive_12_temperatures_low: Annotated[float, _low("drive_12_temperatures")]
    drive_12_temperatures_high: Annotated[float, _high("drive_12_temperatures")]
    drive_12_faults_low: Annotated[float, _low("drive_12_faults")]
    drive_12_faults_high: Annotated[float, _high("drive_12_faults")]
    load_11_motion_0_low: Annotated[float, _low("load_11_motion_0")]
    load_11_motion_0_high: Annotated[float, _high("load_11_motion_0")]
    load_11_motion_1_low: Annotated[float, _low("load_11_motion_1")]
    load_11_motion_1_high: Annotated[float, _high("load_11_motion_1")]
    load_11_motion_2_low: Annotated[float, _low("load_11_motion_2")]
    load_11_motion_2_high: Annotated[float, _high("load_11_motion_2")]
    load_11_motion_3_low: Annotated[float, _low("load_11_motion_3")]
    load_11_motion_3_high: Annotated[float, _high("load_11_motion_3")]
    load_11_motion_4_low: Annotated[float, _low("load_11_motion_4")]
    load_11_motion_4_high: Annotated[float, _high("load_11_motion_4")]
    load_11_electrical_low: Annotated[float, _low("load_11_electrical")]
    load_11_electrical_high: Annotated[float, _high("load_11_electrical")]
    load_11_temperatures_low: Annotated[float, _low("load_11_temperatures")]
    load_11_temperatures_high: Annotated[float, _high("load_11_temperatures")]
    load_11_faults_low: Annotated[float, _low("load_11_faults")]
    load_11_faults_high: Annotated[float, _high("load_11_faults")]
    load_12_motion_0_low: Annotated[float, _low("load_12_motion_0")]
    load_12_motion_0_high: Annotated[float, _high("load_12_motion_0")]
    load_12_motion_1_low: Annotated[float, _low("load_12_motion_1")]
    load_12_motion_1_high: Annotated[float, _high("load_12_motion_1")]
    load_12_motion_2_low: Annotated[float, _low("load_12_motion_2")]
    load_12_motion_2_high: Annotated[float, _high("load_12_motion_2")]
    load_12_motion_3_low: Annotated[float, _low("load_12_motion_3")]
    load_12_motion_3_high: Annotated[float, _high("load_12_motion_3")]
    load_12_motion_4_low: Annotated[float, _low("load_12_motion_4")]
    load_12_motion_4_high: Annotated[float, _high("load_12_motion_4")]
    load_12_electrical_low: Annotated[float, _low("load_12_electrical")]
    load_12_electrical_high: Annotated[float, _high("load_12_electrical")]
    load_12_temperatures_low: Annotated[float, _low("load_12_temperatures")]
    load_12_temperatures_high: Annotated[float, _high("load_12_temperatures")]
    load_12_faults_low: Annotated[float, _low("load_12_faults")]
    load_12_faults_high: Annotated[float, _high("load_12_faults")]


class BusStates(NamedTuple):
    """What the two channels have carried, right circuit and left."""

    load_11: Annotated[float, Field("1", "share of the last period in which it was busy", "bus_11.position")]
    latency_11: Annotated[float, Field("s", "longest from release to arrival in the last period", "bus_11.velocity")]
    lost_11: Annotated[float, Field("1", "frames lost since the start", "bus_11.effort")]
    load_12: Annotated[float, Field("1", "share of the last period in which it was busy", "bus_12.position")]
    latency_12: Annotated[float, Field("s", "longest from release to arrival in the last period", "bus_12.velocity")]
    lost_12: Annotated[float, Field("1", "frames lost since the start", "bus_12.effort")]
