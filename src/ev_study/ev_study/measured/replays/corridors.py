"""Corridors around what was simulated, and what of the record lies in them.

ISO 19364:2016 (steady-state circular driving) draws boundaries around simulated cross plots, in
which the measured ones have to lie; ISO 22140:2021 (lateral transient response) compares time
histories. That is taken from their published scopes. Half the width, offset + gain times magnitude,
and its numbers are ours, and so is that any driving is judged: instant by instant, and as cross
plots by the medians of narrow ranges of lateral acceleration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ev_core.parameters.declaration import parameter
from ev_core.parameters.values import build
from ev_msgs_py.refusal import ParameterError
from ev_stack.figures.panels import IN_FIGURES, Curve, Panel
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.metric import Metric
from ev_stack.report.tables import text_table
from ev_study.measured.records.record import LONGITUDINAL, ROAD_WHEEL_ANGLE, SIDESLIP, YAW_RATE
from ev_study.measured.replays.errors import RANGES, range_names
from ev_study.measured.replays.open_loop import OpenLoop

CORRIDOR = "corridor"  # under which its parameters are given
STEERING = "steering_angle"
_WIDTH = 1.0  # of a range of lateral acceleration in the cross plot [m/s^2]
_FEWEST = 100  # instants in such a range, 1 s at 100 Hz: fewer have no median that counts
_SLOWEST = 1.0  # [m/s]; below it a yaw rate says nothing of the curvature


@dataclass(frozen=True, slots=True)
class CorridorParameters:
    """Half the width of a corridor, offset + gain times the magnitude of what was simulated.

    All assumptions.
    """

    steering_angle_offset: float = parameter(
        0.0035,
        unit="rad",
        low=0.0,
        high=1.0,
        about="of the steering angle: 0.2 deg of the road wheels",
    )
    steering_angle_gain: float = parameter(
        0.1, unit="1", low=0.0, high=10.0, about="of the steering angle"
    )
    yaw_rate_offset: float = parameter(
        0.0175,
        unit="rad/s",
        low=0.0,
        high=10.0,
        about="of the yaw rate: 1 deg/s, 2.5 times the noise of a good sensor",
    )
    yaw_rate_gain: float = parameter(0.1, unit="1", low=0.0, high=10.0, about="of the yaw rate")
    sideslip_offset: float = parameter(
        0.0052,
        unit="rad",
        low=0.0,
        high=1.0,
        about="of the sideslip angle: 0.3 deg, what optical sensors are good for",
    )
    sideslip_gain: float = parameter(
        0.1, unit="1", low=0.0, high=10.0, about="of the sideslip angle"
    )


def corridor_parameters(values: Mapping[str, Any]) -> CorridorParameters:
    """The parameters with these values; ParameterError for one that is refused."""
    try:
        return build(CorridorParameters, values)
    except ParameterError as error:
        raise ParameterError(f"{CORRIDOR}: {error}") from None


@dataclass(frozen=True)
class Corridor:
    """A signal over lateral acceleration [m/s^2], simulated and measured, all of one shape.

    Where nothing was measured (NaN) nothing is judged; a simulated number that is not finite lies
    outside. `offset` and `gain` are those of the corridor, `unit` that of the signal.
    """

    unit: str
    offset: float
    gain: float
    acceleration: tuple[np.ndarray, np.ndarray]  # simulated, measured
    simulated: np.ndarray
    measured: np.ndarray

    def width(self, simulated: np.ndarray) -> np.ndarray:
        """Half of it where this was simulated."""
        return self.offset + self.gain * np.abs(simulated)

    @cached_property
    def counts(self) -> np.ndarray:
        """Mask of the instants that are judged."""
        there: np.ndarray = np.isfinite(self.measured)
        return there

    @cached_property
    def inside(self) -> np.ndarray:
        """Mask of the judged instants that lie in the corridor."""
        # NaN compares as outside, without a warning for each array.
        with np.errstate(invalid="ignore"):
            return self.counts & (
                np.abs(self.measured - self.simulated) <= self.width(self.simulated)
            )

    @property
    def share(self) -> float:
        """Share of the instants that lie in it [1]; NaN if there are none."""
        return _share(self.inside[self.counts])

    @property
    def metric(self) -> Metric:
        """The same for summary.json and the page."""
        return (
            Metric(self.share, "1")
            if self.counts.any()
            else Metric(None, "1", reason="nothing to judge")
        )

    @cached_property
    def shares(self) -> dict[str, float]:
        """The same by range of the magnitude of the measured lateral acceleration."""
        # By the measured acceleration: both cars are judged in the same instants.
        which = np.digitize(np.abs(self.acceleration[1]), RANGES[1:-1])
        return {
            name: _share(self.inside[chosen])
            for n, name in enumerate(range_names())
            if (chosen := self.counts & (which == n)).any()
        }

    @cached_property
    def curves(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Middles of ranges of lateral acceleration [m/s^2], and medians simulated and measured, each at its own."""
        both = self.counts & np.isfinite(self.simulated)
        # Each of both by its own acceleration: a cross plot has no common time.
        ranges = [np.floor(a[both] / _WIDTH).astype(int) for a in self.acceleration]
        values = [each[both] for each in (self.simulated, self.measured)]
        there = [
            n for n in np.unique(ranges[0]) if all((of == n).sum() >= _FEWEST for of in ranges)
        ]
        medians = [
            np.array([np.median(v[of == n]) for n in there])
            for v, of in zip(values, ranges, strict=True)
        ]
        return (np.array(there) + 0.5) * _WIDTH, medians[0], medians[1]

    @property
    def share_of_ranges(self) -> float:
        """Share of ranges with the measured median in the corridor around the simulated one [1].

        NaN without any range.
        """
        _, simulated, measured = self.curves
        return _share(np.abs(measured - simulated) <= self.width(simulated))

    def as_json(self) -> dict[str, Any]:
        """Content for summary.json."""
        shares = {"share": self.share, "share_of_ranges": self.share_of_ranges}
        return {n: v if np.isfinite(v) else None for n, v in shares.items()} | {
            "by_range": self.shares
        }


def corridors_of(
    replay: OpenLoop, simulated: Mapping[str, np.ndarray], p: CorridorParameters
) -> dict[str, Corridor]:
    """The corridors of steering angle, yaw rate and sideslip, as far as they were measured.

    The steering angle is imposed, so what the cars do with it is compared: the angle beyond that of
    a slow bend of the same curvature, delta - atan(L r/u), the ordinate of the steady-state
    characteristic of ISO 4138.
    """
    speeds = simulated[LONGITUDINAL], replay.measured(LONGITUDINAL)
    rates = simulated[YAW_RATE], replay.measured(YAW_RATE)
    acceleration = (speeds[0] * rates[0], speeds[1] * rates[1])
    wheelbase, angle = (
        replay.configurations["plant"].common.vehicle.wheelbase,
        simulated[ROAD_WHEEL_ANGLE],
    )
    # Both with the same measured angle: they differ by the yaw rate that came of it.
    beyond = [angle - _slow_bend(wheelbase, r, u) for r, u in zip(rates, speeds, strict=True)]
    found = {
        STEERING: Corridor(
            "rad", p.steering_angle_offset, p.steering_angle_gain, acceleration, *beyond
        ),
        YAW_RATE: Corridor("rad/s", p.yaw_rate_offset, p.yaw_rate_gain, acceleration, *rates),
    }
    # Yaw rate and steering angle are in every record; the sideslip angle is often not measured.
    if SIDESLIP in replay.compared:
        pair = simulated[SIDESLIP], replay.measured(SIDESLIP)
        found[SIDESLIP] = Corridor("rad", p.sideslip_offset, p.sideslip_gain, acceleration, *pair)
    return found


def _slow_bend(wheelbase: float, yaw_rate: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """The angle [rad] that leads round a bend without slip angles, atan(L r/u); NaN at rest."""
    return np.arctan(wheelbase * yaw_rate / np.where(np.abs(speed) < _SLOWEST, np.nan, speed))


def _share(inside: np.ndarray) -> float:
    return float(np.mean(inside)) if inside.size else float("nan")


def corridor_table(corridors: Mapping[str, Corridor]) -> str:
    """Table for the terminal: instants in each corridor by range, ranges of the cross plot [%]."""
    names = range_names()
    rows = []
    for name, each in corridors.items():
        unit, factor = IN_FIGURES[each.unit]
        shares = [
            each.share,
            *(each.shares.get(label, np.nan) for label in names),
            each.share_of_ranges,
        ]
        rows.append(
            [
                name,
                f"{factor * each.offset:.3g} {unit} + {100 * each.gain:.3g} %",
                *(_percent(s) for s in shares),
            ]
        )
    columns = (
        "in the corridor [%]",
        "half its width",
        "all",
        *(f"{name} m/s2" for name in names),
        "medians",
    )
    return text_table(columns, rows, left=columns[:2])


def _percent(share: float) -> str:
    return f"{100 * share:.1f}" if np.isfinite(share) else "-"


def corridor_sheet(corridors: Mapping[str, Corridor]) -> Sheet:
    """Cross plots over lateral acceleration: medians of narrow ranges, and the boundaries around the simulated ones."""
    panels = []
    for name, each in corridors.items():
        unit, factor = IN_FIGURES[each.unit]
        at, simulated, measured = each.curves
        width = each.width(simulated)
        values = {"simulated": simulated, "measured": measured}
        curves = [Curve(at, factor * v, label) for label, v in values.items()]
        curves += [
            Curve(at, factor * (simulated + sign * width), "boundary") for sign in (1.0, -1.0)
        ]
        what = {STEERING: "steering angle beyond that of a slow bend", YAW_RATE: "yaw rate"}.get(
            name, name
        )
        title = f"{what}: {_percent(each.share)} % of all instants inside"
        panels.append(
            Panel(
                title, f"{what} [{unit}]", curves, xlabel="speed times yaw rate [m/s²]", shape=0.7
            )
        )
    return Sheet(panels, "speed times yaw rate [m/s²]", columns=3)
