"""What a figure shows, before it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ev_sim.measures import motion
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import Runs, channel
from ev_sim.recording.recording import Recording


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Samples (n,) over time (n,) [s]; the label names the curve where a panel holds several.

    `published`: what the source says, not a run.
    """

    time: np.ndarray
    values: np.ndarray
    label: str = ""
    published: bool = False


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes: `ylabel` gives quantity and unit, `note` says why there is nothing to see.

    Panels of a sheet with the same `scale` have the same ordinate. `within`: the ends beyond which a curve may leave
    the panel, so that the others are seen.
    """

    title: str
    ylabel: str
    curves: Sequence[Curve]
    note: str = ""
    scale: str = ""
    within: tuple[float, float] | None = None


def panel(
    title: str,
    ylabel: str,
    curves: Callable[[], Sequence[Curve]],
    scale: str = "",
    within: tuple[float, float] | None = None,
) -> Panel:
    """The panel with these curves, or with the reason why they cannot be computed."""
    try:
        return Panel(title, ylabel, curves(), scale=scale, within=within)
    except NotMeasured as why:
        return Panel(title, ylabel, (), f"not measured: {why}")


def level(value: float, start: float, end: float, label: str = "published") -> Curve:
    """A published number as the line that a curve should keep to from `start` to `end` [s]."""
    return Curve(np.array([start, end]), np.array([value, value]), label, published=True)


Quantity = Callable[[Recording], np.ndarray]


def degrees(quantity: Quantity) -> Quantity:
    """An angle [rad] in degrees."""
    return lambda run: np.degrees(quantity(run))


# Title, ordinate and quantity in its unit.
MOTION: dict[str, tuple[str, str, Quantity]] = {
    "steering_wheel_angle": (
        "Steering-wheel angle",
        "angle [deg]",
        degrees(lambda run: channel(run, motion.STEERING_WHEEL_ANGLE)),
    ),
    "yaw_rate": ("Yaw rate", "yaw rate [deg/s]", degrees(lambda run: channel(run, motion.YAW_RATE))),
    "lateral_acceleration": ("Lateral acceleration", "acceleration [m/s²]", motion.lateral_acceleration_on_path),
    "sideslip_angle": ("Sideslip angle", "angle [deg]", degrees(motion.sideslip_angle)),
}


def over_time(
    runs: Runs, title: str, ylabel: str, quantity: Quantity, within: tuple[float, float] | None = None
) -> Panel:
    """A quantity of every run, labelled with the name of the run if there are several."""

    def curves() -> list[Curve]:
        labels = [name.replace("_", " ") if len(runs) > 1 else "" for name in runs]
        return [Curve(run.time, quantity(run), label) for label, run in zip(labels, runs.values(), strict=True)]

    return panel(title, ylabel, curves, within=within)


def motion_panels(runs: Runs, *names: str) -> list[Panel]:
    """Some quantities of MOTION of every run."""
    return [over_time(runs, *MOTION[name]) for name in names]
