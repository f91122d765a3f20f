"""Fig 4 of Shchur (2019), panels of the wheel speeds in the turns of the cycle."""

from __future__ import annotations

from ev_sim.report.papers import shchur2019 as paper
from ev_sim.report.quantities import derived
from ev_sim.report.samples import mean_between
from ev_sim.verdicts.check import Measure, Number
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.sources.shchur2019.assumptions import ACKERMANN, SIGN_OF_RADIUS
from ev_sim.verdicts.sources.shchur2019.cycle import CYCLE, LEFT, RIGHT, cycle_run, mean_in, recorded
from ev_sim.verdicts.tolerance import relative

_TURNS = ((LEFT, paper.SPEED_LEFT_TURN, paper.TURN_ANGLE), (RIGHT, paper.SPEED_RIGHT_TURN, -paper.TURN_ANGLE))


def _wheel_speeds() -> tuple[Number, ...]:
    return tuple(
        Number(
            "rad/s",
            value,
            relative(0.01, "the driver holds the angle"),
            mean_in(recorded(f"wheel_states.velocity.front_{side}"), window),
            f"{turn} {name}",
        )
        for turn, (window, speed, angle) in zip(("left", "right"), _TURNS, strict=True)
        for side, name, value in zip(("right", "left"), "RL", paper.wheel_speeds(speed, angle), strict=True)
    )


def _speed_differences() -> tuple[Number, ...]:
    def difference(window: tuple[float, float]) -> Measure:
        return lambda driven: mean_between(
            cycle_run(driven), derived.speed_difference(cycle_run(driven), driven.vehicle), *window
        )

    return tuple(
        Number(
            "m/s",
            paper.speed_difference(speed, angle),
            relative(0.01, "the driver holds the angle"),
            difference(window),
            turn,
        )
        for turn, (window, speed, angle) in zip(("left", "right"), _TURNS, strict=True)
    )


DECLARATIONS: tuple[Declaration, ...] = (
    judged("shchur.fig4.wheel_speeds", CYCLE, *_wheel_speeds(), inputs=f"{ACKERMANN}; {SIGN_OF_RADIUS}"),
    judged("shchur.fig4.dV", CYCLE, *_speed_differences(), inputs=f"{ACKERMANN}; {SIGN_OF_RADIUS}"),
)
