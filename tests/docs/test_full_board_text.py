"""Claims of the full board's page, against the numbers that were kept of it.

Each claim computes its words, which have to stand in the page: new runs of the board show which of
them to rewrite.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import pytest

from documentation.full_board import kept
from documentation.full_board_tables import PAGE
from ev_study.benchmark.ranking.tables import EQUAL
from ev_study.benchmark.ranking.varied import Difference

TEXT = " ".join((Path(__file__).parents[2] / PAGE).read_text(encoding="utf-8").split())
# without more beside it
YAW_RATE = ("pi", "lqr", "predictive", "sliding_mode", "super_twisting", "suboptimal")
FURTHER = ("pi_least_squares", "pi_least_loss", "lqr_least_squares", "pi_with_traction_control")
BY_SENSORS = (*YAW_RATE, *FURTHER)  # and without brakes, to a designed understeer
KNOWING_ALL = ("lqr_all_known", "all_known_neutral")
WITH_BRAKES = ("abs_by_drives", "stability_by_drives", "pi_with_abs")
BY_NOISY_SLIP = {"traction_feedback_linearisation", "traction_pi_slip", "pi_with_traction_control"}
PAYING = (*BY_SENSORS, "pi_neutral", "pi_with_abs")  # for a wrong friction and for noise
FOUR_MOTORS = ("layout_1_8_c:all", "mixed_motors:all", "racing_car:all")
CARS = tuple(name for name in kept()["where"] if name.count(":") == 1)
VARIED = kept()["varied"]


def score(law: str, name: str) -> float:
    return kept()["scores"][law][name]["value"]


def lost(law: str) -> float:
    """Share of lost runs [%]."""
    return 100.0 * kept()["scores"][law]["unstable"]


def at(cell: str, law: str, name: str) -> float:
    """A number of a law in a cell or a group of cells."""
    found = kept()["where"].get(cell) or kept()["cells"][f"{cell}:*:v{kept()['version']}"]
    return (found.get(name) or found["medians"][name])[kept()["laws"].index(law)]


def varied(name: str, law: str, of: str = "unstable") -> float:
    """Return how much a law has more at the greater end of a variation."""
    return VARIED[name][of][kept()["laws"].index(law)][0]


def percent(share: float, digits: int = 1) -> str:
    return f"{100.0 * share:.{digits}f}"


def span(values: Iterable[float], digits: int) -> str:
    found = [*values]
    return f"{min(found):.{digits}f} to {max(found):.{digits}f}"


def lap(law: str, cars: Sequence[str] = CARS) -> list[float]:
    """Return the share of time that a law saves against equal torques [%]."""
    cells = [f"{car}:lap:dry" for car in cars]
    return [
        100.0 * (1.0 - at(cell, law, "lap_time") / at(cell, "equal_torque", "lap_time"))
        for cell in cells
    ]


def most(name: str, laws: Iterable[str]) -> float:
    """The largest rise of the cost of handling with what varies."""
    return max(varied(name, law, "handling") for law in laws)


def won_elsewhere() -> list[str]:
    """Cells in which a law without brakes and traction control is below both that know all."""
    laws, found = kept()["laws"], []
    for cell, of in kept()["cells"].items():
        costs = dict(zip(laws, of["handling"], strict=True))
        least = min(
            cost for law, cost in costs.items() if law not in WITH_BRAKES and "traction" not in law
        )
        if least < min(costs[law] for law in KNOWING_ALL) - EQUAL:
            found.append(cell)
    return found


RAMP = "compact_ev:rear:slow_ramp:wet"
BELIEVED, DELAY, FAULT, PERIOD = (
    "told_friction",
    "plant.sensors.imu_yaw_rate.delay",
    "motor_fault",
    "*.control_period",
)
NOISE, NOISE_OF_ACCELERATION = (
    f"plant.sensors.imu_{each}.noise" for each in ("yaw_rate", "acceleration")
)
NOISE_OF_WHEELS = "plant.sensors.wheel_speed.noise"
BEST = kept()["best of each run"]
RUNS = len(kept()["cells"]) * kept()["draws"]
CLAIMS: list[Callable[[], str]] = [
    lambda: (
        f"`equal_torque`, 1 by definition, loses {lost('equal_torque'):.1f} % of the runs, and only"
        f" `load_proportional` loses clearly more ({lost('load_proportional'):.1f} %)"
    ),
    lambda: (
        f"`all_known_neutral` ({score('all_known_neutral', 'handling'):.3f}) and"
        f" `stability_by_drives` ({score('stability_by_drives', 'handling'):.3f}), which are tied"
    ),
    lambda: (
        f"`stability_by_drives` ({score('stability_by_drives', 'worst tenth'):.3f}) and"
        f" `pi_with_abs` ({score('pi_with_abs', 'energy'):.3f}), both with the friction brakes"
    ),
    lambda: (
        f"by sensors ({score('pi_least_loss', 'worst tenth'):.3f},"
        f" {score('pi_least_loss', 'energy'):.3f})"
    ),
    lambda: (
        "it does not bound the others"
        f" ({at('compact_ev:rear', 'all_known_neutral', 'handling'):.2f})"
    ),
    lambda: (
        f"understeer ({score('lqr_all_known', 'worst tenth'):.3f},"
        f" {score('lqr_all_known', 'energy'):.3f})"
    ),
    lambda: (
        f"worst tenth {BEST['worst tenth']:.3f}, no car lost, handling {BEST['handling']:.3f} or,"
        f" by another choice, energy {BEST['energy']:.3f}"
    ),
    lambda: (
        f"In {len(won_elsewhere())} of {len(kept()['cells'])} another law without brakes and"
        " traction control"
    ),
    lambda: (
        f"{sum('launch' in each or 'acceleration' in each for each in won_elsewhere())} of these"
        " are 75 m"
    ),
    lambda: (
        f"loses {round(lost('stability_by_drives') * RUNS / 100)} of {RUNS // 1000} {RUNS % 1000}"
        " runs"
    ),
    lambda: (
        f"{span(map(lost, BY_SENSORS), 1)} % of the runs are unstable with it,"
        f" {lost('equal_torque'):.1f} % with equal torques, but the middle of handling is"
        f" {span((100.0 * score(law, 'handling') - 100.0 for law in BY_SENSORS), 0)} % worse"
    ),
    lambda: (
        f"`pi_neutral` costs {span((at(car, 'pi_neutral', 'handling') for car in FOUR_MOTORS), 2)}"
        f" with four motors, `pi` {span((at(car, 'pi', 'handling') for car in FOUR_MOTORS), 2)}."
        f" With the rear drive it costs {at('compact_ev:rear', 'pi_neutral', 'handling'):.2f} and"
        f" loses {percent(at('compact_ev:rear', 'pi_neutral', 'unstable'), 0)} % of the runs, `pi`"
        f" {at('compact_ev:rear', 'pi', 'handling'):.2f} and"
        f" {percent(at('compact_ev:rear', 'pi', 'unstable'), 0)} %"
    ),
    lambda: (
        f"{span((100.0 * at(RAMP, law, 'unstable') for law in YAW_RATE), 0)} % of the runs are lost"
        " with `pi`, `lqr`, `predictive` and the sliding modes,"
        f" {percent(at(RAMP, 'equal_torque', 'unstable'))} % with equal torques"
    ),
    lambda: (
        f"`lqr` and `predictive` cost {at('racing_car:all', 'lqr', 'handling'):.2f} and "
        f"{at('racing_car:all', 'predictive', 'handling'):.2f} on `racing_car`, with laps of "
        f"{at('racing_car:all:lap:dry', 'lqr', 'lap_time'):.0f} and "
        f"{at('racing_car:all:lap:dry', 'predictive', 'lap_time'):.0f} s for "
        f"{at('racing_car:all:lap:dry', 'equal_torque', 'lap_time'):.0f} s"
    ),
    lambda: (
        f"`pi` loses {percent(varied(BELIEVED, 'pi'))} points more of the runs than with 0.5 to"
        f" 0.83, `lqr` {percent(varied(BELIEVED, 'lqr'))} and `all_known_neutral`"
        f" {percent(varied(BELIEVED, 'all_known_neutral'))}."
    ),
    lambda: (
        f"The mean of handling is {span((varied(BELIEVED, law, 'handling') for law in PAYING), 2)}"
        " higher with laws of a yaw rate by sensors (but `stability_by_drives`), that of energy"
        f" {varied(BELIEVED, 'lqr_all_known', 'energy'):.2f} and"
        f" {varied(BELIEVED, 'all_known_neutral', 'energy'):.2f} with the laws that know all"
    ),
    lambda: (
        f"over all cells `lqr` and `predictive` lose {percent(varied(DELAY, 'lqr'))} and"
        f" {percent(varied(DELAY, 'predictive'))} points more with a delay of two periods, and"
        f" handling costs {varied(DELAY, 'lqr', 'handling'):.2f} and"
        f" {varied(DELAY, 'predictive', 'handling'):.2f} more; `lqr_least_squares` pays"
        f" {varied(DELAY, 'lqr_least_squares', 'handling'):.2f}"
    ),
    lambda: (
        "the noise of the yaw rate costs laws of a yaw rate by sensors"
        f" {span((varied(NOISE, law, 'handling') for law in PAYING), 2)} of handling (but"
        " `stability_by_drives`), that of the acceleration at most"
        f" {most(NOISE_OF_ACCELERATION, kept()['laws']):.2f}, that of the wheel speeds"
        f" {varied(NOISE_OF_WHEELS, 'traction_feedback_linearisation', 'handling'):.2f}"
    ),
    lambda: (
        f"differ from {min(varied(PERIOD, law, 'handling') for law in kept()['laws']):.2f} "
        f"to {most(PERIOD, kept()['laws']):+.2f}."
    ),
    lambda: (
        f"costs equal torques {percent(varied(FAULT, 'equal_torque'))} points and sharing by load "
        f"{percent(varied(FAULT, 'load_proportional'))}, `pi` {percent(varied(FAULT, 'pi'))}, "
        f"`pi_least_squares` {percent(varied(FAULT, 'pi_least_squares'))}."
    ),
    lambda: (
        f"{varied(FAULT, 'abs_by_drives', 'handling'):.2f} more with `abs_by_drives` and "
        f"{varied(FAULT, 'stability_by_drives', 'handling'):.2f} with `stability_by_drives`"
    ),
    lambda: (
        f"(dry: {at('layout_1_8_c:all:double_lane_change:dry', 'pi_neutral', 'entry_speed'):.1f}"
        " m/s for"
        f" {at('layout_1_8_c:all:double_lane_change:dry', 'equal_torque', 'entry_speed'):.1f} with"
        " `layout_1_8_c`)"
    ),
    lambda: f"takes {span((*lap('load_proportional'),), 0)} % off the time on all five cars",
    lambda: (
        f"`pi` takes {span(lap('pi', CARS[1:]), 0)} % off on four, and is {-lap('pi')[0]:.0f} %"
        " slower"
    ),
    lambda: f"`stability_by_drives` {span(lap('stability_by_drives'), 0)} %",
]


@pytest.mark.parametrize("claim", CLAIMS)
def test_words_of_the_page_have_the_numbers_of_the_board(claim: Callable[[], str]):
    assert claim() in TEXT


def test_bounds_that_the_page_names():
    """Each with the words that it has there."""
    laws, ranks = (
        kept()["laws"],
        {law: of["handling"]["rank"] for law, of in kept()["scores"].items()},
    )
    not_lqr = set(laws) - {"lqr", "predictive", "lqr_least_squares"}
    bounds = {
        "18 are worse there beyond the noise, and only two are better": (
            sum(each > ranks["equal_torque"] for each in ranks.values()) == 18
            and ranks["equal_torque"] == 3
        ),
        "which are tied": ranks["all_known_neutral"] == ranks["stability_by_drives"] == 1,
        "no other law more than 0.03": most(DELAY, not_lqr) < 0.035,
        "and at most 0.04 with others": most(NOISE_OF_WHEELS, set(laws) - BY_NOISY_SLIP) < 0.045,
    }
    assert [words for words, holds in bounds.items() if not holds or words not in TEXT] == []


def test_laws_without_sensors_feel_none_and_believe_in_no_friction():
    """Variations that cannot act on a law are tied.

    The comparison within cells finds nothing where there is nothing.
    """
    for name in (BELIEVED, DELAY, NOISE, NOISE_OF_WHEELS):
        for counted in ("handling", "unstable"):
            of_law = VARIED[name][counted][kept()["laws"].index("equal_torque")]
            assert Difference(*of_law).in_words(1.0, 2) == "tied"


def test_no_law_with_a_designed_understeer_by_sensors_and_drives_is_faster_in_the_double_lane_change():
    """The page names the only one by brakes, on wet asphalt."""
    laws, faster = {*BY_SENSORS, "stability_by_drives", "pi_with_abs"}, set()
    for car in CARS:
        for road in ("dry", "wet"):
            cell = f"{car}:double_lane_change:{road}"
            reference = at(cell, "equal_torque", "entry_speed")
            faster |= {(law, car, road) for law in laws if at(cell, law, "entry_speed") > reference}
    assert faster == {("stability_by_drives", car, "wet") for car in FOUR_MOTORS[:2]}
