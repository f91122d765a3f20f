"""The steady turn with equal torques, which follows from the printed equations and parameters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_sim.report.papers import ge_ni2005 as paper
from ev_sim.report.quantities import motion
from ev_sim.report.quantities.two_rear_motors import QUANTITIES, at_the_end, ground_speed, rim_speed, slip
from ev_sim.report.samples import channel, run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Number
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.sources.ge_ni2005.runs import BASELINE, SETTLED, STEADY, of, quantity
from ev_sim.verdicts.tolerance import between, relative

SMALL_ANGLES = relative(0.005, "the closed form takes sines of 2 deg for the angle; measured are 0.06 %")
STEEP = relative(0.02, "steep curve: 1 % of force is 1.5 % of slip")
SPEEDS = relative(0.005, "small angles")
BEGINNING = 0.2  # [s], the time that the radius is left to come down from infinity

_turn = paper.steady_turn()


def _motion(id: str, name: str, value: float) -> Declaration:
    number = Number(QUANTITIES[name][0], value, SMALL_ANGLES, quantity(name, BASELINE))
    return judged(id, STEADY, number)


def _loads() -> tuple[Number, ...]:
    def measure(side: str) -> Callable[[ScenarioRuns], float]:
        return of(BASELINE, at_the_end(lambda run: channel(run, f"tire_forces.load.rear_{side}")))

    left, right = paper.rear_loads()
    return (
        Number("N", left, SMALL_ANGLES, measure("left"), "N_3"),
        Number("N", right, SMALL_ANGLES, measure("right"), "N_4"),
    )


def _slips() -> tuple[Number, ...]:
    left, right = map(paper.slip_of, paper.rear_loads())
    straight = of(BASELINE, lambda run: float(slip(run, "left")[0]))
    return (
        Number("1", left, STEEP, quantity("slip_rear_left", BASELINE), "l3"),
        Number("1", right, STEEP, quantity("slip_rear_right", BASELINE), "l4"),
        Number("1", paper.slip_of(paper.REAR_LOAD), STEEP, straight, "straight"),
    )


def _speeds() -> tuple[Number, ...]:
    def measure(of_wheel: Callable[..., np.ndarray], side: str) -> Callable[[ScenarioRuns], float]:
        def value(driven: ScenarioRuns) -> float:
            run = run_named(driven.runs, BASELINE)
            return motion.value_at(run, of_wheel(run, side, driven.vehicle), paper.INSTANT)

        return value

    (left, right), loads = paper.rear_speeds(), paper.rear_loads()
    rims = [speed / (1.0 - paper.slip_of(load)) for speed, load in zip((left, right), loads, strict=True)]
    return (
        Number("m/s", left, SPEEDS, measure(ground_speed, "left"), "V_3"),
        Number("m/s", right, SPEEDS, measure(ground_speed, "right"), "V_4"),
        Number("m/s", rims[0], SPEEDS, measure(rim_speed, "left"), "rim 3"),
        Number("m/s", rims[1], SPEEDS, measure(rim_speed, "right"), "rim 4"),
    )


def _largest(values: Callable[[Recording], np.ndarray], since: float) -> Callable[[ScenarioRuns], float]:
    def largest(driven: ScenarioRuns) -> float:
        run = run_named(driven.runs, BASELINE)
        return float(np.abs(values(run)[(run.time >= since) & (run.time <= paper.INSTANT)]).max())

    return largest


DECLARATIONS = (
    _motion("ge.eq.yaw_rate", "yaw_rate", _turn.yaw_rate),
    _motion("ge.eq.beta", "sideslip", _turn.sideslip),
    _motion("ge.eq.v", "lateral_speed", _turn.lateral_speed),
    _motion("ge.eq.radius", "radius", _turn.radius),
    _motion("ge.eq.centripetal", "centripetal_acceleration", _turn.centripetal_acceleration),
    judged("ge.eq.loads", STEADY, *_loads()),
    judged("ge.eq.slips", STEADY, *_slips(), assumption="T* on each rear wheel"),
    judged("ge.eq.speeds", STEADY, *_speeds(), assumption="T* on each rear wheel (rim speeds)"),
    judged(
        "ge.fig4b.axis",
        STEADY,
        Number("m", 70.0, between(0.0, 70.0, "inside the axis"), _largest(motion.radius_of_path, BEGINNING)),
        assumption=SETTLED,
    ),
    judged(
        "ge.fig4c.axis",
        STEADY,
        Number("m/s^2", 0.6, between(0.0, 0.6, "inside the axis"), _largest(motion.lateral_acceleration_on_path, 0.0)),
        assumption=SETTLED,
    ),
)
