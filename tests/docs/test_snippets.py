"""Snippets of pages.

Python and YAML are run as they stand, or marked as excerpts of a file that has their lines.
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import ev_stack
from ev_stack.command_line.offered_commands import offered_commands
from ev_stack.command_line.options import arguments
from ev_stack.commands import run_scenario
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.measured.records.mapping import read_record
from ev_study.studies.run_study import arguments as arguments_of_study
from ev_study.studies.study import study_names

ROOT = Path(__file__).parents[2]
PAGES = [*sorted((ROOT / "docs").rglob("*.md")), *ROOT.glob("*.md")]
FENCE = re.compile(
    r"^(?:<!-- excerpt of (?P<of>\S+) -->\n)?```(?P<language>\w+)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)


def snippets(language: str, excerpts: bool = False) -> list[tuple[str, str]]:
    """Page, or the file that an excerpt is of, and text."""
    return [
        (found["of"] if excerpts else page.relative_to(ROOT).as_posix(), found["text"])
        for page in PAGES
        for found in FENCE.finditer(page.read_text())
        if found["language"] == language and bool(found["of"]) == excerpts
    ]


@pytest.mark.parametrize(("file", "text"), snippets("python", excerpts=True))
def test_an_excerpt_has_the_lines_of_its_file(file, text):
    """Lines keep their order.

    Indentation and commas at their ends do not count: the formatter of pages changes them.
    """
    bare = (line.strip().rstrip(",") for line in (ROOT / file).read_text().splitlines())
    assert all(line.strip().rstrip(",") in bare for line in text.splitlines() if line)


@pytest.mark.parametrize("page", dict.fromkeys(page for page, _ in snippets("python")))
def test_python_runs_as_it_stands(page, tmp_path, monkeypatch):
    """All snippets of a page run one behind the other.

    One that declares a law becomes a file, and the law is then driven.
    """
    texts = [text for of, text in snippets("python") if of == page]
    if "gymnasium" in "".join(texts):
        pytest.importorskip("gymnasium")
    monkeypatch.chdir(tmp_path)
    if "@method" in texts[0]:
        Path("law.py").write_text(texts[0])
        assert ev_stack.run(
            "step_steer", runs=("left",), method={"electronic_differential": "law.py"}, duration=0.5
        ).hash
        return
    names: dict = {}
    for text in texts:
        exec(compile(text, page, "exec"), names)


@pytest.mark.parametrize(("page", "text"), snippets("yaml"))
def test_yaml_is_accepted_as_it_stands(page, text, tmp_path):
    """A scenario has the car that it names beside it, a mapping a log.

    Parameters go on top of a lane change.
    """
    file = tmp_path / "shown.yaml"
    file.write_text(text)
    if "/**/scenario:" in text:
        shutil.copy(ROOT / "config" / "vehicles" / "compact_ev.yaml", tmp_path / "car.yaml")
        assert (
            load_scenario(str(file)).runs[0].configurations["plant"].common.vehicle.name
            == "compact_ev"
        )
    elif text.startswith("time:"):
        columns = re.findall(r"column: (\w+)", text)
        rows = [[10.0 * n, *[0.0] * (len(columns) - 1)] for n in range(100)]
        log = tmp_path / "log.csv"
        log.write_text("".join(",".join(map(str, row)) + "\n" for row in (columns, *rows)))
        assert len(read_record(log, file).time) == len(rows)
    else:
        assert not load_scenario("double_lane_change", Overrides(files=[file])).notes


def test_the_scenario_of_the_page_changes_the_lane_and_finds_its_car_beside_it(
    tmp_path, monkeypatch
):
    """The car ends in the middle of the second lane and passes the course."""
    ((_, text),) = [each for each in snippets("yaml") if "/**/scenario:" in each[1]]
    (tmp_path / "lane_change.yaml").write_text(text)
    shutil.copy(ROOT / "config" / "vehicles" / "compact_ev.yaml", tmp_path / "car.yaml")
    monkeypatch.chdir("/")
    result = ev_stack.run(tmp_path / "lane_change.yaml")
    assert result.metrics["course_passed"].value == 1
    # the middle of the second lane
    assert result.signals["pose.y"][-1] == pytest.approx(3.5, abs=0.1)
    assert result.metrics["jerk"].unit == "m/s^3" and np.isfinite(
        result.metrics["yaw_rate_error"].value
    )
    (axes,) = result.figures()["course"].axes
    assert axes.get_title(loc="left").startswith("Single lane change")


README = (ROOT / "README.md").read_text()


def lines_of(text: str) -> list[str]:
    """The commands of a block; one that is continued by a backslash is one line."""
    return text.replace("\\\n", " ").splitlines()


@pytest.mark.parametrize("line", [line for _, text in snippets("bash") for line in lines_of(text)])
def test_commands_that_pages_show_are_understood(line):
    """Scripts and examples are there, and the command line of a run or a study has the options."""
    words = shlex.split(line, comments=True)
    for word in words:
        if re.fullmatch(r"(scripts|docs|benchmarks|tools)/[\w/]+\.\w+", word):
            assert (ROOT / word).is_file(), word
    if words[:1] != ["scripts/run.sh"] or len(words) == 1:
        return
    name, *options = words[1:]
    if name in offered_commands().reviews:
        return
    if name in study_names():
        assert arguments_of_study(name, options)
        return
    if (ROOT / "docs" / "examples" / name).is_dir():
        name = "shchur2019"  # the example is installed before it is driven
    assert arguments([name, *options])


OFFLINE = re.findall(r"scripts/run\.sh [^`\n]*--offline[^`\n]*", README)


@pytest.mark.parametrize("command", OFFLINE)
def test_what_the_readme_drives_offline_drives(command, tmp_path, monkeypatch, capsys):
    """The copy of the car is made where the repository's folders are.

    The run names what it was given.
    """
    for name in ("config", "docs"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    (copied,) = re.findall(r"^cp .*?(?= +#)", README, re.MULTILINE)
    subprocess.run(shlex.split(copied), check=True)
    words = shlex.split(command, comments=True)[1:]
    run_scenario.main([*words, "--duration", "0.1", "--no-report", "--out", "here"])
    assert "signal hash" in capsys.readouterr().out
    summary = json.loads(Path("here/summary.json").read_text())
    assert all(word in summary["command"] for word in words if not word.startswith("-"))


def test_the_readme_has_commands_that_drive():
    assert len(OFFLINE) >= 5
