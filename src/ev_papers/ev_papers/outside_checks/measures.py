"""Measures of the claims: medians and shares of draws, and differences beyond the noise.

Each public function measures one number of published.csv, on the cases of a study. A law is
compared with another one in the same draws, so what a draw has in common cancels.
"""

from __future__ import annotations

import numpy as np

from ev_papers.outside_checks import friction, lap, laws
from ev_papers.outside_checks.cases import BASE, SECOND_ORDER, SENSORS, TRUTH, interval
from ev_study.verdicts.need import StudyCases

# Words of published.csv, and what the studies call them.
_KNOWN = {
    "truth": TRUTH,
    "sensors": SENSORS,
    "wrong": f"{TRUTH}, {laws.WRONG}",
    "sensors_wrong": f"{SENSORS}, {laws.WRONG}",
}
_SETUPS = {"file": "", "less": lap.LESS, "front": lap.FRONT_BRAKES}
_PLACES = {  # driven wheels and road
    "wet": ("all", "wet"),
    "snow": ("all", "snow"),
    "front_wet": ("front", "wet"),
    "rear_wet": ("rear", "wet"),
}


def _draws(
    study: StudyCases,
    quantity: str,
    law: str,
    manoeuvre: str,
    known: str = "truth",
    car: str = "all",
) -> np.ndarray:
    """A quantity of a law in each draw of a manoeuvre, (draws,)."""
    cell = laws.Cell(car, manoeuvre, _KNOWN[known])
    return laws.values(study.results, cell, law, quantity)


def median(
    study: StudyCases,
    quantity: str,
    law: str,
    manoeuvre: str,
    known: str = "truth",
    car: str = "all",
) -> float:
    """Median of the draws of a law in a manoeuvre."""
    return float(np.median(_draws(study, quantity, law, manoeuvre, known, car)))


def surely_less(
    study: StudyCases, quantity: str, law: str, other: str, manoeuvre: str, known: str
) -> bool:
    """True if a law has less than another one beyond the 95 % interval of the median difference."""
    one = _draws(study, quantity, law, manoeuvre, known)
    than = _draws(study, quantity, other, manoeuvre, known)
    _, _, high = interval(one - than)
    return high < 0.0


def surely_more_by_sensors(study: StudyCases, quantity: str, law: str, manoeuvre: str) -> bool:
    """True if a law has more by sensors alone than with the truth, beyond the same interval."""
    by_sensors = _draws(study, quantity, law, manoeuvre, "sensors")
    by_truth = _draws(study, quantity, law, manoeuvre, "truth")
    _, low, _ = interval(by_sensors - by_truth)
    return low > 0.0


def least_change_of_understeer(study: StudyCases) -> float:
    """Least change of the steering-wheel angle at 4 m/s^2 by PI and second-order modes [1]."""
    base = _draws(study, "angle", BASE, "ramp")
    changes = []
    for law in ("pi", *SECOND_ORDER):
        by_draw = _draws(study, "angle", law, "ramp") / base - 1.0
        changes.append(abs(float(np.median(by_draw))))
    return min(changes)


def growth(study: StudyCases, law: str, known: str = "truth") -> float:
    """Growth of the tracking error by wrong tyres in a law, median of the draws [1]."""
    return float(np.median(laws.growth(study.results, _KNOWN[known], law)))


def _sideslips(
    study: StudyCases, law: str, loop: str, factor: float, known: str, place: str
) -> np.ndarray:
    """Largest sideslip angle of each draw with a believed friction, (draws,) [rad]."""
    name = law + friction.LOOP if loop == "loop" else law
    cell = friction.Cell(*_PLACES[place], _KNOWN[known])
    return friction.sideslips(study.results, cell, name, factor)


def held(
    study: StudyCases,
    law: str,
    loop: str,
    factor: float,
    known: str = "truth",
    place: str = "wet",
) -> float:
    """Share of the draws below 10 deg of sideslip, with `loop` or `alone` [1]."""
    return friction.held(_sideslips(study, law, loop, factor, known, place))


def sideslip(
    study: StudyCases,
    law: str,
    loop: str,
    factor: float,
    known: str = "truth",
    place: str = "wet",
) -> float:
    """Median of the largest sideslip angles of the draws [rad]."""
    return float(np.median(_sideslips(study, law, loop, factor, known, place)))


def surely_slides_less(study: StudyCases, law: str, other: str, factor: float) -> bool:
    """True if a law without a loop slides less than another one, beyond the noise."""
    one = _sideslips(study, law, "alone", factor, "truth", "wet")
    than = _sideslips(study, other, "alone", factor, "truth", "wet")
    _, _, high = interval(one - than)
    return high < 0.0


def lap_gain(
    study: StudyCases, law: str, car: str = "all", setup: str = "file", known: str = "truth"
) -> float:
    """Gain of a law over the best clean lap with equal torques, median of the draws [%]."""
    cell = lap.Cell(car, _SETUPS[setup], _KNOWN[known])
    return 100.0 * float(np.median(lap.gains(study.results, cell, law)))


def lap_gain_by_best_brakes(study: StudyCases, law: str) -> float:
    """The same where both have the balance of the brakes with which they are fastest [%]."""
    return 100.0 * float(np.median(lap.gains_by_best_brakes(study.results, law)))


def least_lap_gain(study: StudyCases, law: str) -> float:
    """Lower end of the 95 % interval of the gain with the brakes of the file [%]."""
    _, low, _ = interval(lap.gains(study.results, lap.Cell(), law))
    return 100.0 * low


def best_lap(study: StudyCases, law: str, setup: str = "file") -> float:
    """Best clean lap, median of the draws [s]."""
    cell = lap.Cell(setup=_SETUPS[setup])
    return float(np.median(lap.best(study.results, cell, law)))
