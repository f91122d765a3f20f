"""What the claims are judged by: medians of the draws, shares of draws, and whether a difference is beyond the noise.

Each public function measures one number of published.csv, on the cases of a study.
"""

from __future__ import annotations

import numpy as np

from ev_papers.outside_checks import friction, lap, laws
from ev_papers.outside_checks.cases import BASE, LIMIT, SECOND_ORDER, SENSORS, TRUTH, interval
from ev_study.verdicts.need import StudyCases

_KNOWN = {
    "truth": TRUTH,
    "sensors": SENSORS,
    "wrong": f"{TRUTH}, {laws.WRONG}",
    "sensors_wrong": f"{SENSORS}, {laws.WRONG}",
}


def _of(
    study: StudyCases, quantity: str, law: str, manoeuvre: str, known: str, car: str
) -> np.ndarray:
    return laws.values(study.results, car, manoeuvre, _KNOWN[known], law, quantity)


def median(
    study: StudyCases,
    quantity: str,
    law: str,
    manoeuvre: str,
    known: str = "truth",
    car: str = "all",
) -> float:
    """The median of the draws of a law in a manoeuvre."""
    return float(np.median(_of(study, quantity, law, manoeuvre, known, car)))


def surely_less(
    study: StudyCases,
    quantity: str,
    law: str,
    other: str,
    manoeuvre: str,
    known: str = "truth",
    car: str = "all",
) -> bool:
    """Whether a law has less than another one in the same draws, beyond the 95 % interval of the median difference."""
    one, than = (_of(study, quantity, each, manoeuvre, known, car) for each in (law, other))
    return interval(one - than)[2] < 0.0


def surely_more_by_sensors(study: StudyCases, quantity: str, law: str, manoeuvre: str) -> bool:
    """The same of a law by sensors alone against itself with the truth: whether it has more."""
    sensors, truth = (
        _of(study, quantity, law, manoeuvre, known, "all") for known in ("sensors", "truth")
    )
    return interval(sensors - truth)[1] > 0.0


def least_change_of_understeer(study: StudyCases) -> float:
    """The least change of the steering-wheel angle at 4 m/s^2 by PI and second-order sliding modes [1]."""
    base = _of(study, "angle", BASE, "ramp", "truth", "all")
    changes = [
        _of(study, "angle", law, "ramp", "truth", "all") / base - 1.0
        for law in ("pi", *SECOND_ORDER)
    ]
    return min(abs(float(np.median(each))) for each in changes)


def growth(study: StudyCases, law: str, known: str = "truth") -> float:
    """By what the tracking error grows where the law believes in wrong tyres, median of the draws [1]."""
    return float(np.median(laws.growth(study.results, _KNOWN[known], law)))


def _sideslips(
    study: StudyCases, law: str, loop: str, told: float, known: str, car: str, road: str
) -> np.ndarray:
    name = f"{law} + sideslip" if loop == "loop" else law
    return friction.sideslips(study.results, car, road, _KNOWN[known], name, told)


def held(
    study: StudyCases,
    law: str,
    loop: str,
    told: float,
    known: str = "truth",
    car: str = "all",
    road: str = "wet",
) -> float:
    """The share of the draws whose sideslip stays below 10 deg with a told friction; `loop` or `alone` [1]."""
    return float((_sideslips(study, law, loop, told, known, car, road) < LIMIT).mean())


def sideslip(
    study: StudyCases,
    law: str,
    loop: str,
    told: float,
    known: str = "truth",
    car: str = "all",
    road: str = "wet",
) -> float:
    """The median of the largest sideslip angles of the draws [rad]."""
    return float(np.median(_sideslips(study, law, loop, told, known, car, road)))


def surely_slides_less(study: StudyCases, law: str, other: str, told: float) -> bool:
    """Whether a law slides less than another one with a told friction, without a loop, beyond the noise."""
    one, than = (
        _sideslips(study, each, "alone", told, "truth", "all", "wet") for each in (law, other)
    )
    return interval(one - than)[2] < 0.0


_SETUPS = {"file": "", "less": "accelerates less", "front": lap.FRONT_BRAKES}


def lap_gain(
    study: StudyCases, law: str, car: str = "all", setup: str = "file", known: str = "truth"
) -> float:
    """By what a law shortens the best clean lap of equal torques, median of the draws [%]."""
    return 100.0 * float(
        np.median(lap.gains(study.results, car, law, _SETUPS[setup], _KNOWN[known]))
    )


def lap_gain_by_best_brakes(study: StudyCases, law: str) -> float:
    """The same where each of both has the balance of the brakes with which it is fastest [%]."""
    return 100.0 * float(np.median(lap.gains_by_best_brakes(study.results, law)))


def least_lap_gain(study: StudyCases, law: str) -> float:
    """The lower end of the 95 % interval of the gain with the brakes of the file [%]."""
    return 100.0 * interval(lap.gains(study.results, "all", law))[1]


def best_lap(study: StudyCases, law: str, setup: str = "file") -> float:
    """The best clean lap, median of the draws [s]."""
    return float(np.median(lap.best(study.results, "all", law, _SETUPS[setup])))
