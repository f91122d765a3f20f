"""A page about two runs with signals in closed form."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.topics import TOPICS
from ev_stack.measures.metric import Metric, Reference, within
from ev_stack.recording.recording import PAGE, Recording
from ev_stack.report.page.writing import Image, Page, Signals, write_page
from ev_stack.report.summary import Difference, Summary

CAR = Vehicle()
DURATION, PERIOD, RADIUS = 10.0, 0.01, 20.0
GAP = (400, 500)  # samples of the second run in which the yaw rate is missing
HOSTILE = "</script><img src=x onerror=alert(1)> & </pre>"
_PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010804000000b51c0c020000000b4944415478da6364f80f00010501"
    "01270b18e30000000049454e44ae426082"
)


def run_on_a_circle(speed: float) -> Recording:
    """A car on a circle to the left, all channels, each wheel with its own amplitude."""
    time = np.arange(round(DURATION / PERIOD) + 1) * PERIOD
    names = [name for topic in TOPICS.values() for name in topic.channels]
    channels = {name: (n + 1) * np.sin(time + n) for n, name in enumerate(names)}
    heading = speed / RADIUS * time
    known = {
        "pose.x": RADIUS * np.sin(heading),
        "pose.y": RADIUS * (1 - np.cos(heading)),
        "pose.orientation_z": np.sin(heading / 2),
        "pose.orientation_w": np.cos(heading / 2),
        "twist.longitudinal": np.full_like(time, speed),
        "driver.command.drive_torque": speed * time,
        "driver.command.brake_torque": np.zeros_like(time),
        "steering_column.state.road_wheel_angle": 0.1 * np.sin(time),
    }
    return Recording(time, {**channels, **known})


def two_runs() -> dict[str, Recording]:
    """A slow and a fast one; the second has a gap in its yaw rate."""
    slow, fast = run_on_a_circle(5.0), run_on_a_circle(7.0)
    fast.channels["imu.yaw_rate"][slice(*GAP)] = np.nan
    return {"slow": slow, "fast_one": fast}


def summary_of(runs: dict[str, Recording]) -> Summary:
    """A summary as such runs would leave it."""
    reference = Reference(5.0, within(5.0, relative=0.01), "eq 1")
    return Summary(
        scenario="circles",
        mode="offline",
        seed=3,
        methods={"plant": "planar"},
        parameters={"plant": {"drive": "ideal", "vehicle.mass": 1400.0}},
        vehicle=dataclasses.replace(CAR),
        runs=runs,
        metrics={
            "speed": Metric(5.0, "m/s", reference),
            "nothing": Metric(None, "1", reason="never driven"),
        },
        wall_time=0.5,
        notes=(HOSTILE,),
        about="two circles",
        command="scripts/run.sh circles --offline",
        differs=(Difference("command line", "plant", "drive", "ideal", "averaged", ""),),
    )


def page_of(folder: Path, runs: dict[str, Recording]) -> Path:
    """The page, written into a folder."""
    signals = (Signals("", runs, CAR),)
    images = {"a_figure": Image(_PNG, "Speed: speed [m/s] over time [s]")}
    write_page(Page("circles", {"": summary_of(runs).as_json()}, signals, images), folder / PAGE)
    return folder / PAGE
