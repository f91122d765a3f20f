"""The sweep of Zhileykin (2018) and its variants: what is driven, counted and printed."""

from __future__ import annotations

import math
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest

from documentation.measured import read_measured
from documentation.scenario_results import study_table
from ev_papers.zhileykin2018 import grid as grid
from ev_papers.zhileykin2018 import sweep as sweep
from ev_papers.zhileykin2018 import variants as variants
from ev_papers.zhileykin2018.grid import LIMIT
from ev_study.studies.driving import drive_cases
from ev_study.studies.study import CaseResult, drive_case
from ev_study.verdicts.need import StudyNeed

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "zhileykin2018.md").read_text()
CALM = dict.fromkeys(("h_n", "h_2", "h_4"), 0)


def counted(study, peak) -> dict[str, float]:
    """Metrics of a study in which `peak` gives the sideslip angle of a case [rad]."""
    cases = study.cases(Namespace())
    results = {
        case.name: CaseResult(case.name, {"peak_sideslip": peak(case), **CALM}) for case in cases
    }
    return {name: metric.value for name, metric in study.metrics(Namespace(), results).items()}


def block(name: str) -> str:
    """A generated part of the page."""
    return PAGE.partition(f"<!-- generated: {name} -->\n")[2].partition("<!-- end")[0].strip()


def test_sweep_table_of_the_page_is_that_of_its_cases():
    """It comes from the numbers beside docs/verdicts.md, some of which tests/docs drives."""
    kept = read_measured(ROOT, StudyNeed("zhileykin2018_sweep")).results
    assert len(kept) == 10 * 40
    assert block("zhileykin2018_sweep") == study_table("zhileykin2018_sweep", kept).strip()


@pytest.mark.weekly
@pytest.mark.slow
def test_a_row_of_the_variants_is_that_of_its_cases():
    (variant,) = (each for each in variants.VARIANTS if each.name == "S0_high")
    cases = grid.cases_of((grid.REAR_DRIVE, "k1"), variant.values, variant.name)
    results = {result.name: result for result in drive_cases(cases, variants.measure)}
    spins, held = grid.spins(results, variant.name), grid.holds(results, "k1", variant.name)
    (row,) = (
        line for line in block("zhileykin2018_variants").splitlines() if variant.title in line
    )
    _, _, printed_spins, _, printed_k1, *_ = (cell.strip() for cell in row.split("|"))
    assert (printed_spins, printed_k1) == (
        str(spins.sum()),
        f"{(spins & held).sum()} ({held.sum()})",
    )


def test_holds_are_counted_among_the_cases_in_which_rear_drive_spins():
    """Rear drive spins from 3000 N on, 24 cases.

    k = 0.5 holds below 3500 N, 24 cases of which 8 count.
    """

    def peak(case) -> float:
        force = float(case.name.split()[1])
        spins = {"rear_drive": force >= 3000.0, "k05": force >= 3500.0}
        return LIMIT if spins.get(case.run, False) else 0.9 * LIMIT

    found = counted(sweep, peak)
    assert (found["cases"], found["rear_drive_spins"]) == (40, 24)
    assert (found["holds_where_rear_drive_spins_k05"], found["holds_k05"]) == (8, 24)
    assert (found["holds_where_rear_drive_spins_fixed_split"], found["holds_fixed_split"]) == (
        24,
        40,
    )
    assert found["calm_k1"] == 40


def test_every_reading_is_driven_in_all_cases_and_given_to_the_law():
    """Rear drive, K = 0.48, 0.5, 1, the equality, three second branches, two ways, a fixed half."""
    cases = sweep.cases(Namespace())
    assert len(cases) == 10 * 40 == len({case.name for case in cases})
    settings = {case.name.split()[0]: case.values[4:] for case in cases}
    assert settings["k1"] == settings["equality"] == ()
    assert settings["k1_derived"] == (("electronic_differential", "second_branch", "derived"),)
    assert {case.run for case in cases} == set(grid.CONTROLS)


@pytest.mark.slow
def test_engine_and_converter_drive_the_sweep():
    """All controls at 3000 N and 6 deg.

    None is refused, rear drive spins, the fixed half holds, as with motors.
    """
    cases = [
        case for case in sweep.cases(Namespace(drive="engine")) if " 3000 N 6 deg" in case.name
    ]
    assert len(cases) == 10 and all(set(grid.ENGINE) <= set(case.values) for case in cases)
    peak = {
        case.run: drive_case(case, sweep.measure)
        for case in cases
        if case.run in ("rear_drive", "fixed_split")
    }
    assert not any(result.refused for result in peak.values())
    assert (
        peak["rear_drive"].measured["peak_sideslip"]
        > LIMIT
        > peak["fixed_split"].measured["peak_sideslip"]
    )


def test_a_refused_case_neither_holds_nor_spins():
    assert counted(sweep, lambda case: math.nan)["rear_drive_spins"] == 0.0
    assert counted(sweep, lambda case: math.nan)["holds_fixed_split"] == 0.0


def test_a_reading_of_the_law_is_counted_against_the_rear_drive_of_the_base():
    """Only the law is driven again.

    3 of the 5 controls, and rear drive of the base says which cases count.
    """
    cases = variants.cases(Namespace())
    of_law = [each for each in variants.VARIANTS if each.of_law]
    assert len(cases) == 40 * (5 * (len(variants.VARIANTS) - len(of_law)) + 3 * len(of_law))
    assert len({case.name for case in cases}) == len(cases)

    def peak(case) -> float:
        return LIMIT if case.run == "rear_drive" and case.name.endswith(" base") else 0.0

    found = counted(variants, peak)
    assert (
        found["rear_drive_spins_by_geometry"]
        == found["holds_where_rear_drive_spins_k1_by_geometry"]
        == 40
    )
    assert (
        found["rear_drive_spins_S0_high"] == found["holds_where_rear_drive_spins_k1_S0_high"] == 0
    )


def test_every_variant_is_a_row_of_the_page():
    for each in variants.VARIANTS:
        assert f"| {each.title} | " in PAGE


@pytest.mark.parametrize("name", [each.name for each in variants.VARIANTS])
def test_a_variant_changes_what_it_says(name):
    """A variant moves k = 0.5 at 3000 N and 6 deg.

    The base never slows down, so no rule on that counts.
    """
    (variant,) = (each for each in variants.VARIANTS if each.name == name)
    driven = {}
    for each in (variant, variants.BASE):
        cases = grid.cases_of(("k05",), each.values, each.name)
        (case,) = (case for case in cases if case.name.startswith("k05 3000 N 6 deg"))
        driven[each.name] = drive_case(case, sweep.measure)
        assert not driven[each.name].refused
    same = driven[name].signal_hash == driven["base"].signal_hash
    assert same == (name in ("base", "command", "deceleration"))


def test_heat_maps_have_one_field_for_each_case():
    cases = sweep.cases(Namespace())
    results = {case.name: CaseResult(case.name, {"peak_sideslip": 0.1, **CALM}) for case in cases}
    assert grid.of_all(results, "k1").shape == (len(grid.FORCES), len(grid.ANGLES))
    assert np.isclose(grid.of_all(results, "k1"), 0.1).all()
    assert set(sweep.figures(Namespace(), results)) == {"sideslip"}
