"""What the law is said to change against equal torques: judged in all three readings of eq 8, on the source's car."""

from __future__ import annotations

from collections.abc import Callable

from ev_papers.ge_ni2005 import paper
from ev_papers.ge_ni2005.quantities import QUANTITIES, OfRun, ground_speed, own_response_time, response_time
from ev_sim.measures import motion
from ev_sim.measures.metric import Metric
from ev_sim.measures.samples import run_named
from ev_sim.verdicts.check import Basis, Comparison, Measure, Number, between, larger, smaller
from ev_sim.verdicts.declaration import judged, no_verdict, not_judgeable
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.sources import published

BASELINE = "equal_torque"
READINGS = ("rate", "offset", "increment")
FREE_SPEED, FULL_CAR = "_free_speed", "_full_car"
STEADY = ScenarioNeed("ge_ni2005", runs=(BASELINE,))
COMPARED = ScenarioNeed("ge_ni2005", runs=(BASELINE, *READINGS))
COMPARED_FREE = ScenarioNeed("ge_ni2005", runs=tuple(f"{name}{FREE_SPEED}" for name in (BASELINE, *READINGS)))
CASES = ("", FREE_SPEED, FULL_CAR, FULL_CAR + FREE_SPEED)  # what the names of runs end with: car and speed
SETTLED = "T* on each rear wheel, settled before the turn, the wheels turned at once"
EACH = f"{SETTLED}; T = k sgn(D) read as rate, offset and increment, each judged"


def of(run: str, measure: OfRun) -> Callable[[ScenarioRuns], float]:
    """A measure of one of the runs."""
    return lambda driven: measure(run_named(driven.runs, run))


def quantity(name: str, run: str) -> Callable[[ScenarioRuns], float]:
    """A quantity of one of the runs by its name."""
    return of(run, QUANTITIES[name][1])


MARGIN, WHY = 0.01, "no curve is left, only the order; 1 % of the larger one keeps noise out"

# Whether a quantity is larger with the law, by id and, for the friction use, by driven wheel.
ORDERINGS = {
    "ge.claim.beta": {"": ("sideslip", True)},
    "ge.claim.radius": {"": ("radius", False)},
    "ge.claim.centripetal": {"": ("centripetal_acceleration", True)},
    "ge.claim.yaw_rate": {"": ("yaw_rate", True)},
    "ge.claim.v": {"": ("lateral_speed", True)},
    "ge.claim.slip_use": {
        " left": ("friction_use_rear_left", True),
        " right": ("friction_use_rear_right", True),
    },
    "ge.claim.speed": {"": ("longitudinal_speed", True)},
}


def judged_case(id: str) -> str:
    """The case that an ordering is judged in: u held, but for the speed itself."""
    return FREE_SPEED if id == "ge.claim.speed" else ""


def orderings(id: str, case: str) -> tuple[Comparison, ...]:
    """An ordering with each reading, in a case of car and speed."""
    return tuple(
        Comparison(
            QUANTITIES[name][0],
            larger,
            MARGIN,
            WHY,
            quantity(name, reading + case),
            quantity(name, BASELINE + case),
            f"{reading}{side}{case}".replace("_", " "),
        )
        for reading in READINGS
        for side, (name, larger) in ORDERINGS[id].items()
    )


def elsewhere(driven: ScenarioRuns) -> dict[str, Metric]:
    """The orderings in the other cases: u free, and the car whose forces follow the loads; by id and run."""
    return {
        f"{id}.{check.name.replace(' ', '_')}": check.metric(Basis(published("ge_ni2005")[id], EACH), (driven,))
        for id in ORDERINGS
        for case in CASES
        if case != judged_case(id) and (FREE_SPEED in case or id != "ge.claim.speed")
        for check in orderings(id, case)
    }


def _to_equal_torques(run: str) -> Measure:
    """Time to 90 % of the yaw rate that equal torques reach [s]."""

    def time(driven: ScenarioRuns) -> float:
        final = quantity("yaw_rate", BASELINE)(driven)
        return response_time(run_named(driven.runs, run), final)

    return time


def _responses() -> tuple[Comparison, ...]:
    return tuple(
        smaller("s", measure(reading), measure(BASELINE), MARGIN, WHY, f"{reading} to {aim}")
        for reading in READINGS
        for aim, measure in (
            ("its own yaw rate", lambda run: of(run, own_response_time)),
            ("that of equal torques", _to_equal_torques),
        )
    )


_half_of_target = Number(
    "1",
    paper.TARGET / 2,
    between(0.0, paper.TARGET / 2, "clearly below: under half of l3*"),
    quantity("slip_rear_right", BASELINE),
)

_CLAIMS_DECLARATIONS = (
    *(judged(id, COMPARED, *orderings(id, ""), assumption=EACH) for id in ORDERINGS if not judged_case(id)),
    judged("ge.claim.speed", COMPARED_FREE, *orderings("ge.claim.speed", FREE_SPEED), assumption=f"{EACH}; u free"),
    judged("ge.claim.outer_slip_low", STEADY, _half_of_target, assumption=SETTLED),
    judged("ge.claim.response", COMPARED, *_responses(), assumption=EACH),
    not_judgeable("ge.claim.robust", "no run of the source shows it"),
)


LOST = tuple(f"ge.fig3{panel}" for panel in "abcde") + tuple(f"ge.fig4{panel}" for panel in "ade")


def _speed(side: str, run: str) -> Measure:
    def measure(driven: ScenarioRuns) -> float:
        recording = run_named(driven.runs, run)
        return motion.value_at(recording, ground_speed(recording, side, driven.vehicle), paper.INSTANT)

    return measure


_FIGURES_DECLARATIONS = (
    not_judgeable(
        "ge.fig3f_4f",
        "curve not in the text; beyond it, V_4 above V_3",
        (COMPARED,),
        *(
            larger("m/s", _speed("right", run), _speed("left", run), MARGIN, WHY, name)
            for name, run in (("4f", BASELINE), ("3f", "rate"))
        ),
    ),
    *(not_judgeable(id, "curve not in the text", (COMPARED,)) for id in LOST),
    *(no_verdict(id, "a scheme without numbers") for id in ("ge.fig1", "ge.fig2")),
)


DECLARATIONS = (*_CLAIMS_DECLARATIONS, *_FIGURES_DECLARATIONS)
