"""The study of faults, on some of its cases: a dead front motor in mid-turn."""

from __future__ import annotations

import argparse

import pytest

from ev_study.studies import faults
from ev_study.studies.study import CaseResult, drive_case

pytestmark = pytest.mark.slow

POWERED = "power_steering (powered)"
DEAD = ("inner motor dead", "outer motor dead")


def given(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    faults.add_options(parser)
    return parser.parse_args(words)


GIVEN = given("--laws", "power_steering", POWERED, "--faults", "none", *DEAD)


@pytest.fixture(scope="module")
def results() -> dict[str, CaseResult]:
    return {case.name: drive_case(case, faults.measure) for case in faults.cases(GIVEN)}


def measured(results, *of: str) -> dict:
    return results[faults.name_of(*of)].measured


def test_every_fault_with_every_law_on_both_roads_by_default():
    names = [case.name for case in faults.cases(given())]
    assert (
        len(names)
        == len(set(names))
        == 2 * len(faults.laws()) * (len(faults.FAULTS) + len(faults.OF_MOTORS) + 1)
    )


def test_all_are_driven_and_the_limp_mode_does_nothing_to_a_sound_car(results):
    assert not any(result.refused for result in results.values())
    for law in GIVEN.laws:
        for road in faults.ROADS:
            sound, limp = (
                results[faults.name_of("none", law, asr, road)] for asr in ("off", "limp_home")
            )
            assert measured(results, "none", law, "off", road)["path_error"] < 0.3
            assert sound.measured["path_error"] == limp.measured["path_error"]


@pytest.mark.parametrize("road", ["dry", "wet"])
@pytest.mark.parametrize("fault", DEAD)
def test_power_steering_keeps_its_lane_with_a_dead_motor(results, fault, road):
    """A column without a lever for the drives keeps the lane, better in limp mode.

    On that of the source it does so in limp mode alone.
    """
    off, limp = (
        measured(results, fault, "power_steering", asr, road) for asr in ("off", "limp_home")
    )
    assert faults.is_safe(GIVEN, off) and faults.is_safe(GIVEN, limp)
    assert limp["path_error"] < off["path_error"]
    assert limp["end_speed"] < off["end_speed"]  # it coasts
    assert not faults.is_safe(GIVEN, measured(results, fault, POWERED, "off", road))
    powered = measured(results, fault, POWERED, "limp_home", road)
    assert faults.is_safe(GIVEN, powered)
    # it coasts
    assert (
        powered["end_speed"]
        < measured(results, "none", POWERED, "limp_home", road)["end_speed"] - 3.0
    )


def test_table_metrics_and_figure(results):
    rows = faults.rows(GIVEN, results)
    assert len(rows) == 12 and all(len(row) == len(faults.COLUMNS) for row in rows)
    assert faults.metrics(GIVEN, results)["safe_power_steering"].value == 4.0
    assert len(faults.figures(GIVEN, results)["power_steering"].panels) == 8
