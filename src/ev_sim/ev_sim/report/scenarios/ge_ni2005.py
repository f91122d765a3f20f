"""Report on Ge & Ni (2005), figs 3 and 4: slip targets for each rear wheel beside equal torques.

A run is called by its control (`equal_torque`, or the reading of the law) and by what differs from the source's run:
`_free_speed` where u is not held, `_switched` where there is no boundary layer, `_reached` where the target slip is low
enough to be reached, `_estimated` where the law estimates the speed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.claim import LARGER, SMALLER, comparison
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.metric import Band, Metric, Reference, metric, within
from ev_sim.report.papers import ge_ni2005 as paper
from ev_sim.report.quantities import motion
from ev_sim.report.samples import Runs, channel, run_named
from ev_sim.run.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BASELINE = "equal_torque"
READINGS = ("rate", "offset", "increment")
FREE_SPEED, SWITCHED, REACHED = "_free_speed", "_switched", "_reached"
CHATTERING = ("rate_reached", "offset_reached", "increment")  # runs that come to their target slip
CLOSED_FORM = 0.01  # band of the closed form; the car has two tracks, load transfer and no small angles
CHATTER_WINDOW = 1.0  # [s], the last one
CALM = (0.0, 0.1)
WIDEST_RADIUS = 200.0  # [m], beyond which fig. (b) shows nothing: the path begins straight

Measure = Callable[[Recording], float]


def _at_the_end(values: Callable[[Recording], np.ndarray]) -> Measure:
    return lambda run: motion.value_at(run, values(run), paper.INSTANT)


def _response_time(run: Recording) -> float:
    """Time to 90 % of the run's own yaw rate in the end [s]."""
    yaw_rate = channel(run, motion.YAW_RATE)
    share = yaw_rate / motion.value_at(run, yaw_rate, paper.INSTANT)
    return motion.crossing_time(run.time, share, 0.9, "90 % of the final yaw rate")


def _chatter(run: Recording) -> float:
    """How far both torque requests go to and fro, per time [N m/s]; one way only is no chatter."""
    late = run.time >= run.time[-1] - CHATTER_WINDOW
    torques = [channel(run, f"torque_request.drive.rear_{side}")[late] for side in ("left", "right")]
    return (
        sum(float(np.abs(np.diff(torque)).sum() - abs(torque[-1] - torque[0])) for torque in torques) / CHATTER_WINDOW
    )


QUANTITIES: dict[str, tuple[str, Measure]] = {
    "yaw_rate": ("rad/s", _at_the_end(lambda run: channel(run, motion.YAW_RATE))),
    "sideslip": ("rad", _at_the_end(motion.sideslip_angle)),
    "lateral_speed": ("m/s", _at_the_end(lambda run: channel(run, "twist.lateral"))),
    "radius": ("m", _at_the_end(motion.radius_of_path)),
    "centripetal_acceleration": ("m/s^2", _at_the_end(motion.lateral_acceleration_on_path)),
    "slip_rear_left": ("1", _at_the_end(lambda run: channel(run, "tire_forces.slip_ratio.rear_left"))),
    "slip_rear_right": ("1", _at_the_end(lambda run: channel(run, "tire_forces.slip_ratio.rear_right"))),
    "longitudinal_speed": ("m/s", _at_the_end(lambda run: channel(run, "twist.longitudinal"))),
    "response_time": ("s", _response_time),
    "chatter": ("N m/s", _chatter),
}
CLAIMS = {  # in a left turn, where the right wheel is the outer one
    "yaw_rate": (LARGER, "higher yaw rate"),
    "sideslip": (LARGER, "larger sideslip angle"),
    "lateral_speed": (LARGER, "higher lateral speed"),
    "radius": (SMALLER, "smaller radius of the path"),
    "centripetal_acceleration": (LARGER, "higher centripetal acceleration"),
    "slip_rear_right": (LARGER, "more slip, and so more use of the friction, at the outer wheel"),
    "response_time": (SMALLER, "faster response (to 90 % of its own final yaw rate)"),
}
FREE_CLAIMS = {quantity: claim for quantity, claim in CLAIMS.items() if quantity != "response_time"} | {
    "longitudinal_speed": (LARGER, "higher speed")  # which is held in the source's run
}


def metrics(runs: Runs) -> dict[str, Metric]:
    """Each quantity of figs 3 and 4 at 3 s in each run, the chatter of the torque, and the published claims.

    Of runs that differ in the boundary layer only, the chatter.
    """
    closed = paper.steady_turn()

    def reference(quantity: str, name: str) -> Reference | None:
        value = getattr(closed, quantity, None) if name == BASELINE else None
        if value is None:
            return None
        source = "not printed; follows from eqs. 1 and 2 in steady state, with X_3 = X_4 and the printed parameters"
        return Reference(value, within(value, relative=CLOSED_FORM), source)

    values = {
        f"{quantity}_{name}": metric(_in(runs, name, quantity), unit, reference(quantity, name))
        for name in runs
        for quantity, (unit, _) in QUANTITIES.items()
        if quantity == "chatter" or not any(case in name for case in (SWITCHED, REACHED))
    }
    claims: dict[str, Metric] = {}
    for reading in READINGS:
        assumption = f"reading {reading} of T = k sgn(D)"
        claims |= _orderings(runs, CLAIMS, reading, BASELINE, assumption)
        claims |= _orderings(
            runs, FREE_CLAIMS, reading + FREE_SPEED, BASELINE + FREE_SPEED, f"{assumption}; u not held"
        )
    for name in CHATTERING:
        claims[f"claim_no_chatter_{name}"] = comparison(
            "the boundary layer takes the chatter away (less than a tenth is left)",
            CALM,
            _in(runs, name, "chatter"),
            _in(runs, name + SWITCHED, "chatter"),
            QUANTITIES["chatter"][0],
            f"reading {name.partition('_')[0]} of T = k sgn(D)",
        )
    return values | claims


def _orderings(
    runs: Runs, claims: dict[str, tuple[Band, str]], name: str, baseline: str, assumption: str
) -> dict[str, Metric]:
    return {
        f"claim_{'larger' if band == LARGER else 'smaller'}_{quantity}_{name}": comparison(
            f"{statement} than with equal torques",
            band,
            _in(runs, name, quantity),
            _in(runs, baseline, quantity),
            QUANTITIES[quantity][0],
            assumption,
        )
        for quantity, (band, statement) in claims.items()
    }


def _in(runs: Runs, name: str, quantity: str) -> Callable[[], float]:
    return lambda: QUANTITIES[quantity][1](run_named(runs, name))


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Figure]:
    """Figs 3 and 4 with u held, the same with u free, and the torques with and without boundary layer."""
    from ev_sim.report.figures.drawing import sheet

    torques = [
        panel(
            f"{name.replace('_', ' ')}: torque, rear {side}",
            "torque [N m]",
            lambda name=name, side=side: _curves(
                runs, (name, name + SWITCHED), lambda run: channel(run, f"torque_request.drive.rear_{side}")
            ),
        )
        for name in CHATTERING
        for side in ("left", "right")
    ]
    return {
        "fig3_fig4": sheet(_panels(runs, vehicle, ""), "time [s]"),
        "fig3_fig4_free_speed": sheet(_panels(runs, vehicle, FREE_SPEED), "time [s]"),
        "boundary_layer": sheet(torques, "time [s]"),
    }


def _panels(runs: Runs, vehicle: Vehicle, case: str) -> list[Panel]:
    names = [name + case for name in (BASELINE, *READINGS)]

    def of(title: str, ylabel: str, quantity: Callable[[Recording], np.ndarray]) -> Panel:
        return panel(title, ylabel, lambda: _curves(runs, names, quantity))

    def radius(run: Recording) -> np.ndarray:
        values = motion.radius_of_path(run)
        return np.where(np.abs(values) < WIDEST_RADIUS, values, np.nan)

    def wheel(title: str, ylabel: str, name: str, scale: float = 1.0) -> list[Panel]:
        return [
            of(f"{title}, rear {side}", ylabel, lambda run, side=side: scale * channel(run, f"{name}.rear_{side}"))
            for side in ("left", "right")
        ]

    return [
        of("a  Sideslip angle", "angle [deg]", lambda run: np.degrees(motion.sideslip_angle(run))),
        of("b  Radius of the path", "radius [m]", radius),
        of("c  Centripetal acceleration", "acceleration [m/s²]", motion.lateral_acceleration_on_path),
        of("Longitudinal speed", "speed [m/s]", lambda run: channel(run, "twist.longitudinal")),
        of("d  Yaw rate", "yaw rate [rad/s]", lambda run: channel(run, motion.YAW_RATE)),
        of("d  Lateral speed", "speed [m/s]", lambda run: channel(run, "twist.lateral")),
        *wheel("e  Slip", "slip [1]", "tire_forces.slip_ratio"),
        *wheel("f  Rim speed", "speed [m/s]", "wheel_states.velocity", vehicle.wheel_radius),
    ]


def _curves(runs: Runs, names: Iterable[str], quantity: Callable[[Recording], np.ndarray]) -> list[Curve]:
    chosen = {name: run_named(runs, name) for name in names}
    return [Curve(run.time, quantity(run), name.replace("_", " ")) for name, run in chosen.items()]
