"""Tolerances, margins and the words of verdicts."""

from __future__ import annotations

import math

import pytest

from ev_sim.measures.metric import NotMeasured
from ev_sim.verdicts.check import Number, absolute, between, holds, larger, relative, smaller
from ev_sim.verdicts.declaration import judged, no_verdict, not_judgeable
from ev_sim.verdicts.sources import Published
from ev_sim.verdicts.table import plain_table
from ev_sim.verdicts.verdict import Verdict, verdict

OF = Published("x.y", "follows", "eq 1", "a number", "2 m")


def number(value: float, name: str = "") -> Number:
    return Number("m", 2.0, relative(0.01, "algebra"), lambda: value, name)


def missing() -> float:
    raise NotMeasured("there is no run z")


def of(*checks, **words) -> Verdict:
    return verdict(OF, judged("x.y", (), *checks, **words), ())


@pytest.mark.parametrize(
    ("tolerance", "unit", "band", "text"),
    [
        (relative(0.01, "w"), "m", (1.98, 2.02), "1 %: w"),
        (absolute(0.5, "w"), "m", (1.5, 2.5), "0.5 m: w"),
        (absolute(0.5, "w"), "%", (1.5, 2.5), "0.5 points: w"),
        (between(0.0, 3.0, "w"), "m", (0.0, 3.0), "0 .. 3 m: w"),
        (between(1.0, math.inf, "w"), "1", (1.0, math.inf), "at least 1: w"),
        (between(-math.inf, 1.0, "w"), "s", (-math.inf, 1.0), "at most 1 s: w"),
    ],
)
def test_tolerances(tolerance, unit, band, text):
    assert tolerance.band(2.0) == pytest.approx(band)
    assert tolerance.text(unit) == text


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_comparison_needs_a_margin(sign: float):
    """1 % of the larger number: 1.009 against 1 is no difference, 1.011 is one; equal magnitudes never are."""

    def judgement(kind, a: float, b: float) -> str:
        return of(kind("m", lambda: sign * a, lambda: b, 0.01, "noise")).judgement

    assert judgement(larger, 1.011, 1.0) == judgement(smaller, 1.0, 1.011) == "reproduced"
    assert judgement(larger, 1.009, 1.0) == judgement(smaller, 1.0, 1.009) == "not reproduced"
    assert judgement(larger, 1.0, 1.0) == judgement(smaller, 1.0, 1.0) == "not reproduced"
    assert judgement(larger, 1.0, 1.011) == judgement(smaller, 1.011, 1.0) == "not reproduced"


def test_an_id_holds_if_all_of_its_numbers_do():
    assert of(number(2.01), number(2.0, "b")).text == "reproduced"
    assert of(number(2.01), number(2.1, "b")).text == "not reproduced"
    assert of(number(2.01), number(2.1, "b")).ours == "2.01 m; b 2.1 m"
    assert of(holds(lambda: False, "w")).judgement == "not reproduced"


def test_words_of_verdicts():
    assert of(number(2.0), assumption="A").text == "reproduced with assumption A"
    assert of(number(3.0), assumption="A").text == "not reproduced"
    assert of(number(2.0), inputs="I").text == "follows from the inputs: I"
    assert of(number(3.0), inputs="I").text == "not reproduced"
    assert of(number(math.nan)).text == "not measured: the result is nan"
    assert of(Number("m", 2.0, relative(0.01, "w"), missing)).text == "not measured: there is no run z"
    assert of(larger("m", missing, lambda: 1.0, 0.01, "w")).text == "not measured: there is no run z"
    assert of(number(2.0)).run == "closed form"


def test_what_is_not_judged_shows_its_numbers_all_the_same():
    shown = verdict(OF, not_judgeable("x.y", "lost", (), number(3.0)), ())
    assert (shown.text, shown.ours) == ("not judgeable: lost", "3 m")
    assert verdict(OF, no_verdict("x.y", "a scheme"), ()).text == "no verdict: a scheme"


def test_open_bands_are_valid_json():
    entry = of(larger("m", lambda: 2.0, lambda: 1.0, 0.5, "w")).as_json()["values"][""]
    assert entry["band"] == [2.0, None]
    assert entry["source"] == "follows: eq 1; measured 2 against 1 m"


def test_lines_for_the_terminal_are_cut():
    found = [of(number(2.0), number(2.01, "a name that is too long for the line"), assumption="A")]
    table = plain_table(found, 60).splitlines()
    assert table[0].split() == ["id", "verdict", "ours"]
    assert all(len(line) <= 60 for line in table)
    assert table[-1].startswith("x.y  reproduced with assumption  2 m; a name")
    assert table[-1].endswith("…")
