"""Frames of a CAN bus as signals: each payload as two words of 32 bits, which a float64 holds exactly; -1: no frame.

A period has a place for each tick of 1 ms, of which the first ones are used; what comes less often has one place.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from ev_msgs_py.contract.fields import Field

MOST_TICKS = 5  # of 1 ms, in a control period


def _halves(name: str, frame: str) -> list[tuple[str, Any]]:
    """The two fields of a payload."""
    low = Field("1", "bits 0 to 31 of the payload", f"{frame}.position")
    high = Field("1", "bits 32 to 63 of the payload", f"{frame}.velocity")
    return [(f"{name}_low", Annotated[float, low]), (f"{name}_high", Annotated[float, high])]


def _set_points(device: str) -> list[tuple[str, Any]]:
    return [field for tick in range(MOST_TICKS) for field in _halves(f"{device}_{tick}", f"{device}_set_point_{tick}")]


def _heartbeat(circuit: str) -> tuple[str, Any]:
    """Its one field, because so short a payload has no other half."""
    name = f"heartbeat_{circuit}"
    return name, _halves(name, name)[0][1]


def _feedback(device: str) -> list[tuple[str, Any]]:
    names = [f"{device}_motion_{tick}" for tick in range(MOST_TICKS)]
    names += [f"{device}_{kind}" for kind in ("electrical", "temperatures", "faults")]
    return [field for name in names for field in _halves(name, name)]


def _signal(name: str, *fields: list[tuple[str, Any]]) -> Any:
    return NamedTuple(name, [field for some in fields for field in some])


_SET_POINTS: Any = _signal(
    "SetPointFrames",
    *map(_set_points, ("drive_11", "drive_12")),
    [_heartbeat("11"), _heartbeat("12")],
    *map(_set_points, ("load_11", "load_12")),
)
_FEEDBACK: Any = _signal("FeedbackFrames", *map(_feedback, ("drive_11", "drive_12", "load_11", "load_12")))


class SetPointFrames(_SET_POINTS):  # type: ignore[misc]  # its fields are made above
    """What the controller puts on the bus in the ticks from this instant on."""

    __slots__ = ()


class FeedbackFrames(_FEEDBACK):  # type: ignore[misc]  # its fields are made above
    """What has arrived at the controller in the ticks before this instant."""

    __slots__ = ()


class BusStates(NamedTuple):
    """What the two channels have carried, right circuit and left."""

    load_11: Annotated[float, Field("1", "share of the last period in which it was busy", "bus_11.position")]
    latency_11: Annotated[float, Field("s", "longest from release to arrival in the last period", "bus_11.velocity")]
    lost_11: Annotated[float, Field("1", "frames lost since the start", "bus_11.effort")]
    load_12: Annotated[float, Field("1", "share of the last period in which it was busy", "bus_12.position")]
    latency_12: Annotated[float, Field("s", "longest from release to arrival in the last period", "bus_12.velocity")]
    lost_12: Annotated[float, Field("1", "frames lost since the start", "bus_12.effort")]
