"""A source comes in by one folder (docs/examples/own_source) and goes out with one.

Nothing else names it.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "own_source"
PAPERS = ROOT / "src" / "ev_papers"
REMOVED = "zhileykin2018"
IMPORT = re.compile(r"^\s*(?:from|import) ev_papers\b", re.MULTILINE)


def program(*calls: list[str]) -> str:
    return f"from ev_stack.commands.run_scenario import main\nfor words in {calls}: main(words)"


def output_of(code: str, installed: Path, folder: Path) -> str:
    """Return what a program prints in a folder; its path begins with the installed packages."""
    path = f"{installed}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    command = [sys.executable, "-c", code]
    run = subprocess.run(
        command, cwd=folder, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, as pip installs it."""
    folder = tmp_path_factory.mktemp("own_source")
    shutil.copytree(EXAMPLE, folder / "source")  # building leaves something behind in it
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "-q",
        "--no-deps",
        "--no-build-isolation",
        "--no-index",
    ]
    subprocess.run(
        [*pip, "--target", str(folder / "lib"), str(folder / "source")],
        check=True,
        capture_output=True,
    )
    return folder / "lib"


def test_an_installed_source_is_listed_driven_and_reported_with_its_verdicts(
    installed: Path, tmp_path: Path
):
    """An installed source brings its law and its scenario; twice in a row."""
    driven = ["own_source", "--offline", "--out"]
    calls = program(["--list"], [*driven, "first"], [*driven, "out"])
    listed = output_of(calls, installed, tmp_path)
    names = [line.split()[0] for line in listed.splitlines() if line.strip()]
    assert {"own_source", "outer_wheel"} <= set(names)
    metrics = json.loads((tmp_path / "out" / "summary.json").read_text())["metrics"]
    assert list(metrics) == ["own.difference", "own.sum", "own.turns_in"]
    assert (tmp_path / "out" / "fig1.png").is_file()


def test_its_verdicts_are_those_of_its_page(installed: Path, tmp_path: Path):
    judged = ["verdicts", "--only", "own_source", "--out"]
    output_of(program([*judged, "first"], [*judged, "out"]), installed, tmp_path)
    rows = re.findall(
        r"^\| `(own\.\w+)` \|(.*)\|$", (tmp_path / "out" / "verdicts.md").read_text(), re.MULTILINE
    )
    found = {id: [cell.strip() for cell in cells.split("|")] for id, cells in rows}
    page = re.findall(
        r"^\| `(own\.\w+)` \| .* \| (.*) \| (.*) \|$",
        (EXAMPLE / "own_source.md").read_text(),
        re.MULTILINE,
    )
    assert len(page) == 3
    for id, ours, verdict in page:
        assert ours in found[id]
        assert verdict in found[id]


def test_its_law_keeps_the_contract(installed: Path, tmp_path: Path):
    output_of("from ev_core.check.method import check_method; check_method('electronic_differential', 'outer_wheel')",
         installed, tmp_path)  # fmt: skip


@pytest.fixture(scope="module")
def without(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the papers' package without the folder of one of them, with new metadata."""
    package = tmp_path_factory.mktemp("without") / "ev_papers"
    shutil.copytree(
        PAPERS, package, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", REMOVED)
    )
    subprocess.run(
        [sys.executable, "setup.py", "-q", "egg_info"], cwd=package, check=True, capture_output=True
    )
    return package


def test_without_the_folder_of_a_source_the_others_are_listed(without: Path, tmp_path: Path):
    code = (
        "from ev_study.verdicts.verdict import wanted\nfrom ev_study.verdicts.sources import sources\n"
        "print(*sources())\nprint(*sorted({source for source, _ in wanted((), quick=False)}))"
    )
    known, judged = output_of(code, without, tmp_path).splitlines()
    left = ["dissertation", "ge_ni2005", "outside_checks", "shchur2019", "tatar_chudzik"]
    assert sorted(known.split()) == judged.split() == left


@pytest.mark.weekly
def test_without_the_folder_of_a_source_everything_else_runs(without: Path, tmp_path: Path):
    """Its scenario, too, which has the report then that all have that bring none."""
    short = ["--offline", "--no-record", "--duration", "0.5"]
    code = program(
        ["--list"],
        ["shchur2019", *short, "--out", "other"],
        [REMOVED, *short, "--out", "its"],
        ["verdicts", "--only", "shchur.hold30", "--out", "verdicts"],
    )
    text = output_of(code, without, tmp_path)
    assert f"{REMOVED}_sweep" not in text
    assert "shchur.hold30.manual" in text
    assert (
        "rear_drive_final_speed"
        in json.loads((tmp_path / "its" / "summary.json").read_text())["metrics"]
    )


def test_no_other_package_imports_the_papers():
    others = [path for path in (ROOT / "src").rglob("*.py") if PAPERS not in path.parents]
    assert len(others) > 300
    assert [path for path in others if IMPORT.search(path.read_text())] == []


@pytest.mark.parametrize(
    "source", [path.parent.name for path in PAPERS.glob("ev_papers/*/source.py")]
)
def test_no_paper_imports_another_one(source: str):
    texts = [path.read_text() for path in (PAPERS / "ev_papers" / source).rglob("*.py")]
    assert {name for text in texts for name in re.findall(r"ev_papers\.(\w+)", text)} <= {source}
