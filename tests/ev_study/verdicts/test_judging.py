"""Tolerances, margins and the words of verdicts."""

from __future__ import annotations

import math

import pytest

from ev_stack.measures.metric import NotMeasured
from ev_study.verdicts.check import SHOWN, Check, Tolerance, check_of
from ev_study.verdicts.measure import Template
from ev_study.verdicts.sources import Published
from ev_study.verdicts.verdict import Verdict, failures, plain_table, verdict


def missing() -> float:
    raise NotMeasured("there is no run z")


MEASURES = {"number": float, "missing": missing}


def check(
    measure: str, value: str = "2", tolerance: str = "1 %", unit: str = "m", name: str = ""
) -> Check:
    why = "" if value == SHOWN else "algebra"
    row = {
        "measure": measure,
        "value": value,
        "tolerance": tolerance,
        "unit": unit,
        "name": name,
        "why": why,
    }
    return check_of(row, MEASURES, ())


def of(*checks: Check, **notes: str) -> Verdict:
    (note, text), *_ = *notes.items(), ("", "")
    note = note.replace("_", " ")
    return verdict(
        Published("x.y", "follows", "eq 1", "a number", "2 m", (), checks, note, Template((text,))),
        (),
    )


@pytest.mark.parametrize(
    ("tolerance", "unit", "band", "text"),
    [
        ("1 %", "m", (1.98, 2.02), "1 %: w"),
        ("0 %", "m", (2.0, 2.0), "0 %: w"),
        ("0.5", "m", (1.5, 2.5), "0.5 m: w"),
        ("0.5", "%", (1.5, 2.5), "0.5 points: w"),
        ("0 .. 3", "m", (0.0, 3.0), "0 .. 3 m: w"),
        ("1 ..", "1", (1.0, math.inf), "at least 1: w"),
        (".. 1", "s", (-math.inf, 1.0), "at most 1 s: w"),
    ],
)
def test_tolerances(tolerance: str, unit: str, band, text: str):
    found = Tolerance.of(tolerance, "w")
    assert found.band(2.0) == pytest.approx(band)
    assert found.text(unit) == text


@pytest.mark.parametrize("sign", ["", "-"])
def test_a_comparison_needs_a_margin(sign: str):
    """1 % of the larger number: 1.009 against 1 is no difference, 1.011 is one.

    Equal magnitudes never are.
    """

    def judgement(a: str, b: str) -> str:
        one, relation, other = a, *b.split()
        return of(check(f"number {sign}{one} {relation} number {other}", value="")).judgement

    assert judgement("1.011", "> 1.0") == judgement("1.0", "< 1.011") == "reproduced"
    assert judgement("1.009", "> 1.0") == judgement("1.0", "< 1.009") == "not reproduced"
    assert judgement("1.0", "> 1.0") == judgement("1.0", "< 1.0") == "not reproduced"
    assert judgement("1.0", "> 1.011") == judgement("1.011", "< 1.0") == "not reproduced"


def test_an_id_holds_if_all_of_its_numbers_do():
    assert of(check("number 2.01"), check("number 2.0", name="b")).text == "reproduced"
    one = of(check("number 2.01"), check("number 2.1", name="b"), assumption="A")
    assert one.text == "not reproduced: by b; A"
    assert failures([one, of(check("number 2"))]) == "x.y: not reproduced: by b; A"
    assert of(check("number 2.01"), check("number 2.1", name="b")).ours == "2.01 m; b 2.1 m"
    numbers = (check("number 2.1"), check("number 2.1", name="b"), check("number 2", name="c"))
    assert of(*numbers, assumption="A").text == "not reproduced: by the first number; b; A"


def test_words_of_verdicts():
    assert of(check("number 2"), assumption="A").text == "reproduced with assumption A"
    assert of(check("number 3"), assumption="A").text == "not reproduced: A"
    assert of(check("number 2"), fitted="F").text == "reproduced with a fitted number: F"
    assert of(check("number 3"), fitted="F").text == "not reproduced: F"
    assert of(check("number 2"), inputs="I").text == "follows from the inputs: I"
    assert of(check("number 3"), inputs="I").text == "not reproduced: I"
    assert of(check("number nan")).text == "not measured: the result is nan"
    assert of(check("missing")).text == "not measured: there is no run z"
    assert of(check("missing > number 1", value="")).text == "not measured: there is no run z"
    assert of(check("number 2")).run == "closed form"


def test_a_number_that_is_shown_is_not_judged():
    found = of(check("number 2"), check("number 9", value=SHOWN, tolerance="", name="beside"))
    assert (found.text, found.ours) == ("reproduced", "2 m; beside 9 m")
    assert found.tolerance == "1 %: algebra; shown, not judged"


def test_what_is_not_judged_shows_its_numbers_all_the_same():
    shown = of(check("number 3"), not_judgeable="lost")
    assert (shown.text, shown.ours) == ("not judgeable: lost", "3 m")
    assert of(no_verdict="a scheme").text == "no verdict: a scheme"


def test_open_bands_are_valid_json():
    entry = of(check("number 2 > number 1", value="", tolerance="50 %")).as_json()["values"][""]
    assert entry["band"] == [2.0, None]
    assert entry["source"] == "follows: eq 1; measured 2 against 1 m"


def test_lines_for_the_terminal_are_cut():
    found = [
        of(
            check("number 2"),
            check("number 2.01", name="a name that is too long for the line"),
            assumption="A",
        )
    ]
    table = plain_table(found, 60).splitlines()
    assert table[0].split() == ["id", "verdict", "ours"]
    assert all(len(line) <= 60 for line in table)
    assert table[-1].startswith("x.y  reproduced with assumption  2 m; a name")
    assert table[-1].endswith("…")
