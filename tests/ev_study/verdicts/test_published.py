"""Every published id is judged, once, and a mistake in a list of published things is one line."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from ev_msgs_py.refusal import ParameterError
from ev_study.verdicts import sources as of_sources
from ev_study.verdicts.measure import measures_of
from ev_study.verdicts.need import ScenarioNeed, StudyNeed, need_of
from ev_study.verdicts.sources import COLUMNS, published, published_value, sources

# How many numbers, curves and claims each source published; a line more or less in its list is a
# mistake.
PUBLISHED = {
    "shchur2019": 42,
    "ge_ni2005": 45,
    "tatar_chudzik": 31,
    "dissertation": 272,
    "zhileykin2018": 29,
    "outside_checks": 14,
}


@pytest.mark.parametrize("source", sources())
def test_list_of_published_things_is_complete(source: str):
    assert len(published(source)) == PUBLISHED[source]


@pytest.mark.parametrize("source", sources())
def test_what_is_judged_has_checks_and_what_is_lost_has_a_reason(source: str):
    for id, of in published(source).items():
        assert of.checks if of.is_judged else of.text.parts[0], id


@pytest.mark.parametrize("source", sources())
def test_every_text_is_used_and_every_measure_is_named(source: str):
    folder = Path(of_sources.source_named(source).__file__).parent
    text = (folder / "published.csv").read_text()
    short = folder / "texts.csv"
    texts = short.read_text().splitlines()[2:] if short.is_file() else []
    named = text + "\n".join(texts)
    assert [
        line.partition(",")[0] for line in texts if f"{{{line.partition(',')[0]}}}" not in named
    ] == []
    assert {name for name in of_sources.source_named(source).MEASURES if name not in named} == set()


def test_one_source_is_loaded_without_the_others():
    """Each brings libraries of its own, which cost a second of every run of a scenario."""
    text = (
        "import sys; from ev_study.verdicts.sources import published; assert published('shchur2019'); "
        "print(*sorted({name.split('.')[1] for name in sys.modules if name.startswith('ev_papers.')}))"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["shchur2019"]


GOOD = {
    "id": "own.a",
    "kind": "printed",
    "quantity": "a length",
    "measure": "length 2",
    "unit": "m",
    "value": "2",
    "tolerance": "1 %",
    "why": "algebra",
}


@pytest.fixture
def listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a function that lists published rows, of cells or of a file's text.

    `length` and `word` are the measures.
    """

    def of(*rows: dict[str, str] | str):
        module = tmp_path / "own.py"
        module.write_text("")
        measures = {"length": lambda factor=1.0: factor, "word": lambda: "3 %"}
        monkeypatch.setattr(of_sources, "offered", lambda group: {"own": "own"})
        monkeypatch.setattr(
            of_sources, "find_spec", lambda name: SimpleNamespace(origin=str(module))
        )
        monkeypatch.setattr(
            of_sources, "source_named", lambda name: SimpleNamespace(MEASURES=measures)
        )
        lines = [
            row if isinstance(row, str) else ",".join(row.get(name, "") for name in COLUMNS)
            for row in rows
        ]
        (tmp_path / "published.csv").write_text("\n".join([",".join(COLUMNS), *lines]))
        for each in (published, of_sources._rows_by_id):
            each.cache_clear()
        return published("own")

    yield of
    for each in (published, of_sources._rows_by_id):
        each.cache_clear()


def test_a_row_is_a_check_and_a_row_without_id_another_one(listed):
    of = listed(
        {**GOOD, "note": "inputs: it is given"},
        {**GOOD, "id": "", "kind": "", "quantity": "", "name": "b"},
    )
    first, second = of["own.a"].checks
    assert (first.name, second.name, first.value, first.allowed(())) == (
        "",
        "b",
        2.0,
        "1 %: algebra",
    )
    assert of["own.a"].metrics({})["b"].judgement == "follows from the inputs"
    assert published_value("own", "own.a", "b") == 2.0


def test_what_is_in_braces_is_a_text_or_a_measure(listed, tmp_path: Path):
    (tmp_path / "texts.csv").write_text("name,text\nlong,a long text\nlonger,{long} and more\n")
    of = listed({**GOOD, "note": "assumption: {longer} {length 7}", "tolerance": "{word}"})["own.a"]
    assert of.noted({}) == "a long text and more 7"
    assert of.checks[0].allowed(()) == "3 %: algebra"


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        (
            {"measure": "lenght"},
            "unknown measure 'lenght'; did you mean length? known: length, parameter, word",
        ),
        ({"measure": "length 1 2"}, "measure 'length 1 2' is refused"),
        (
            {"measure": "vehicle.mas"},
            "the measure 'vehicle.mas' is refused: 0 are driven, expected",
        ),
        (
            {"measure": "mean(pose.x)", "driven": "five_methods"},
            "the measure 'mean(pose.x)' is refused: an",
        ),
        (
            {"measure": "vehicle.mas", "driven": "shchur2019"},
            "the measure 'vehicle.mas' is refused: unknown vehicle parameter 'mas'; did you mean mass",
        ),
        (
            {"measure": "slow: pose.x", "driven": "shchur2019"},
            "the measure 'slow: pose.x' is refused: it has a value at each sample, expected one number",
        ),
        ({"measure": ""}, "the measure is missing, expected its name"),
        (
            {"tolerance": ""},
            "the tolerance is missing, expected one with its reason, or 'shown' for the value",
        ),
        ({"tolerance": "about 1"}, "the tolerance 'about 1' is refused, expected such as '1 %'"),
        ({"tolerance": "-1"}, "the tolerance '-1' is refused"),
        ({"tolerance": "nan"}, "the tolerance 'nan' is refused"),
        ({"tolerance": "3 .. 1"}, "the tolerance '3 .. 1' is refused"),
        ({"why": ""}, "the tolerance '1 %' has no reason, expected one in the column why"),
        (
            {"unit": "meter"},
            "the unit 'meter' is not known, expected such as 'N m', 'm/s^2' or '1', of ",
        ),
        ({"unit": ""}, "the unit '' is not known"),
        ({"value": "nan"}, "the value 'nan' is refused, expected a finite number or 'shown'"),
        ({"value": ""}, "the value '' is refused, expected a finite number or 'shown'"),
        ({"value": "two"}, "the value 'two' is refused"),
        ({"value": "shown"}, "the tolerance '1 %' is refused, expected beside shown is none"),
        (
            {"measure": "length > length 2"},
            "the value '2' is refused, expected for a comparison is none",
        ),
        (
            {"measure": "length > length 2", "value": "", "tolerance": "0.1"},
            "the tolerance '0.1' is refused, expected for a comparison is more than 0 % and less than 100 %",
        ),
        (
            {"note": "because"},
            "the note 'because' is refused, expected one that begins with assumption: ",
        ),
        ({"note": "assumption: {lenght}"}, "unknown measure 'lenght'"),
        (
            {"kind": "guessed"},
            "kind 'guessed' is refused, expected printed, follows, words, axes, lost",
        ),
        (
            {"driven": "urban_mixed --speed 3"},
            "what is driven: '--speed 3' is refused, expected a scenario with",
        ),
        (
            {"driven": "urban_mixed --duration long"},
            "what is driven: argument --duration: 'long' is refused",
        ),
        (
            {"driven": "urban_mixed --set speed"},
            "--set 'speed' is refused, expected NODE.PARAM=VALUE",
        ),
        (
            {"measure": "", "unit": "", "value": "", "tolerance": "", "why": ""},
            "nothing is measured, expected that",
        ),
    ],
)
def test_a_mistake_is_one_line(listed, tmp_path: Path, changed: dict[str, str], line: str):
    with pytest.raises(ParameterError) as refused:
        listed({**GOOD, **changed})
    message = str(refused.value)
    assert message.startswith(f"{tmp_path / 'published.csv'}, line 2, own.a: {line}")
    assert "\n" not in message


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ([GOOD, GOOD], "line 3, own.a: the id is listed twice, expected once"),
        (
            [GOOD, {**GOOD, "id": ""}],
            "line 3, own.a: a row without id has kind, where, quantity, printed, expected",
        ),
        (
            [GOOD, {**GOOD, "id": "", "kind": "", "quantity": ""}],
            "line 2, own.a: two of its numbers have one name",
        ),
        ([{**GOOD, "id": ""}], "line 2, no id: a row without id has"),
        ([{**GOOD, "quantity": "a, b"}], "line 2: 14 cells, expected 13: quote what has commas"),
    ],
)
def test_a_mistake_of_several_rows_is_one_line(
    listed, tmp_path: Path, rows: list[dict[str, str]], line: str
):
    with pytest.raises(ParameterError) as refused:
        listed(*rows)
    assert str(refused.value).startswith(f"{tmp_path / 'published.csv'}, {line}")


def test_a_file_with_other_columns_is_refused(listed, tmp_path: Path):
    (tmp_path / "texts.csv").write_text("text,name\n")
    with pytest.raises(
        ParameterError, match=r"texts\.csv, line 1: the columns are refused, expected name,text$"
    ):
        listed(GOOD)


def test_what_is_driven_is_as_on_the_command_line():
    text = "urban_mixed --set driver.pedals.time=[0.0] --set asr.method=\"'off'\" --duration 3 --runs a b"
    values = (("driver", "pedals.time", (0.0,)), ("asr", "method", "off"))
    assert need_of(text) == ScenarioNeed("urban_mixed", values, ("a", "b"), 3.0)
    assert need_of("urban_mixed --slow").slow
    assert need_of("five_methods --seeds 2") == StudyNeed("five_methods", ("--seeds", "2"))
    assert need_of("five_methods --quick") == StudyNeed("five_methods", slow=False)


def test_two_measures_of_one_name_are_refused():
    from ev_papers.ge_ni2005 import measures, quantities

    with pytest.raises(
        ValueError, match=r"chatter of ev_papers\.ge_ni2005\.quantities is a measure of"
    ):
        measures_of(measures, quantities)
