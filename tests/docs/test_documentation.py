"""The pages say what the code says, and the examples in them work."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers.source_runs import driven

from documentation.markdown import block_names, built, built_names, table, with_blocks
from documentation.pages import stale_pages
from documentation.results import control_period_table, drive_all, result_table
from documentation.scenario_results import SCENARIO_PAGES, results_of
from ev_stack.commands.run_scenario import main as run_scenario
from ev_stack.recording.recording import load, signal_hash

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "docs" / "examples"
PAGES = sorted(
    [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *ROOT.glob("docs/*.md")]
)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
DURATION = 1.0  # s of simulated time of the runs with the examples; the car is accelerating
LIMIT = 50.0  # N m, far below the 250 N m for each wheel that the acceleration takes


def test_generated_parts_are_fresh():
    stale = [str(page.relative_to(ROOT)) for page in stale_pages(ROOT)]
    assert not stale, "run scripts/document.sh"


def test_only_the_text_between_the_marks_changes():
    end = "<!-- end of generated -->"
    page = f"a\n<!-- generated: x -->\nold\n{end}\nb <!-- generated: y -->\n{end}"
    assert block_names(page) == ["x", "y"]
    assert with_blocks(page, {"x": "new\n"}) == page.replace("old", "new")


def test_a_mark_and_the_line_behind_it_become_the_part_of_the_built_page():
    page = "a\n<!-- built: x -->\n*elsewhere*\n\nb\n"
    assert built_names(page) == ["x"]
    assert built(page, {"x": "| new |\n"}) == "a\n| new |\n\nb\n"


def test_bars_in_a_cell_do_not_end_it():
    assert table(("a",), [("|x|",)]).splitlines()[-1] == r"| \|x\| |"


def test_results_are_those_of_the_runs():
    compare_results("docs/shchur2019.md", result_table(drive_all()))


def test_control_periods_are_those_of_the_runs():
    compare_results("docs/shchur2019.md", control_period_table(), "control periods")


@pytest.mark.parametrize("page", SCENARIO_PAGES)
def test_results_of_a_scenario_are_those_of_its_runs(page: str):
    of = SCENARIO_PAGES[page]
    compare_results(page, results_of(of, driven(of.scenario)))


def compare_results(page: str, text: str, block: str = "results"):
    """Numbers, not text: another processor may round the last digit differently."""
    written = (
        (ROOT / page)
        .read_text()
        .partition(f"<!-- generated: {block} -->")[2]
        .partition("<!-- end")[0]
    )
    lines, now = written.strip().splitlines(), text.strip().splitlines()
    assert [NUMBER.sub("", line) for line in lines] == [NUMBER.sub("", line) for line in now]
    for line_written, line_now in zip(lines, now, strict=True):
        numbers = [float(number) for number in NUMBER.findall(line_written)]
        assert numbers == pytest.approx(
            [float(n) for n in NUMBER.findall(line_now)], rel=1e-3, abs=1e-9
        ), "document.sh --runs"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path):
    for target in re.findall(r"\]\(([^)]+)\)", page.read_text()):
        if not target.startswith("http"):
            path, _, anchor = target.partition("#")
            linked = page.parent / path if path else page
            assert linked.exists(), target
            assert not anchor or anchor in _anchors(linked), target


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_are_named_with_their_folder_are_there(page: Path):
    """Paths begin at the top of the repository or of one of the packages."""
    named = re.findall(r"`(\w[\w/]*/\w+\.(?:py|sh|yaml|csv))`", page.read_text())
    folders = [ROOT, *ROOT.glob("src/*"), *(folder / folder.name for folder in ROOT.glob("src/*"))]
    assert [name for name in named if not any((folder / name).exists() for folder in folders)] == []


def _anchors(page: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_images_are_small():
    images = list((ROOT / "docs" / "images").glob("*.png"))
    assert images
    assert all(image.stat().st_size < 300_000 for image in images)


def test_every_image_is_shown():
    shown = "\n".join(page.read_text() for page in PAGES)
    images = [image.name for image in (ROOT / "docs" / "images").iterdir()]
    assert [name for name in images if f"images/{name})" not in shown] == []


def test_the_page_of_running_shows_every_option_of_run_sh(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        run_scenario(["--help"])
    options = set(re.findall(r"--[a-z][a-z-]+", capsys.readouterr().out))
    described = (
        (ROOT / "docs" / "running.md")
        .read_text()
        .partition("## Ways to run")[2]
        .partition("\n## ")[0]
    )
    assert set(re.findall(r"--[a-z][a-z-]+", described)) == options


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a short run with the built-in nodes."""
    folder = tmp_path_factory.mktemp("built_in")
    run_scenario(
        [
            "shchur2019",
            "--offline",
            "--no-record",
            "--duration",
            str(DURATION),
            "--out",
            str(folder),
        ]
    )
    return folder


def drive_with_own_node(out: Path, *arguments: str) -> Path:
    """The signals of the same run over DDS with own_node.py as the asr."""
    command = " ".join([sys.executable, str(EXAMPLES / "own_node.py"), *arguments])
    run_scenario(
        [
            "shchur2019",
            "--no-record",
            "--duration",
            str(DURATION),
            "--out",
            str(out),
            "--node",
            f"asr={command}",
        ]
    )
    return out / "signals.npz"


@pytest.mark.weekly
def test_own_node_with_an_equal_law_gives_the_equal_hash(built_in: Path, tmp_path: Path):
    """The limit of 1000 N m is never reached, so the law is that of `off`."""
    own = drive_with_own_node(tmp_path / "own")
    assert signal_hash(load(own)) == signal_hash(load(built_in / "signals.npz"))


def test_own_node_replaces_the_built_in_one(tmp_path: Path):
    limited = load(drive_with_own_node(tmp_path / "own", "--ros-args", "-p", f"limit:={LIMIT}"))
    assert np.max(limited.channels["torque_request.drive.front_left"]) > LIMIT
    assert np.max(limited.channels["torque_command.drive.front_left"]) == LIMIT


def test_own_methods_are_held_against_the_contract():
    command = [sys.executable, str(EXAMPLES / "check_own_law.py")]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert output.count("keeps the contract") == 5


def test_a_first_law_takes_few_lines_and_few_things_to_know():
    """A yaw-rate feedback, one state and two parameters, and the table of its author's concepts."""
    assert len((EXAMPLES / "yaw_feedback.py").read_text().splitlines()) <= 35
    page = (ROOT / "docs" / "own_things.md").read_text()
    table = page.partition("| what | how |\n| --- | --- |\n")[2].partition("\n\n")[0]
    assert len(table.splitlines()) <= 8


def test_yaw_feedback_lowers_the_error_that_the_page_says():
    """Numbers of the page are those of a run without and one with the law.

    Each has a process of its own, where its method is registered.
    """
    page = (ROOT / "docs" / "own_things.md").read_text()
    printed = re.search(r"falls from ([\d.]+) rad/s with equal torques to ([\d.]+)\.", page)
    assert errors_of_yaw_rate("yaw_feedback", {}) == [*printed.groups()]


def errors_of_yaw_rate(module: str, *given: dict) -> list[str]:
    """Errors in `double_lane_change` [rad/s].

    With equal torques, and with the law of an example and these values.
    """
    code = (
        f"import {module}, ev_stack; from ev_stack.measures.handling import yaw_rate_error as error\n"
        f"for name, values in (('equal_torque', {{}}), *(({module!r}, each) for each in {given!r})):\n"
        "    values = {f'electronic_differential.{key}': value for key, value in {'method': name, **values}.items()}\n"
        "    result = ev_stack.run('double_lane_change', set=values)\n"
        "    (run,) = result.runs.values()\n"
        "    print(round(error(run, result.summary().vehicle), 3))\n"
    )
    command = [sys.executable, "-c", code]
    return subprocess.run(
        command, cwd=EXAMPLES, check=True, capture_output=True, text=True
    ).stdout.split()


def test_yaw_moment_lowers_the_error_that_the_page_says():
    """Numbers of the page are those of runs in a process of their own.

    There registered methods are not seen by other tests.
    """
    found = errors_of_yaw_rate("yaw_moment", {}, {"control": "sliding_mode"})
    page = (ROOT / "docs" / "own_things.md").read_text()
    printed = re.search(
        r"falls from ([\d.]+) rad/s \(equal torques\) to ([\d.]+) and ([\d.]+),", page
    )
    assert found == list(printed.groups())


@pytest.mark.parametrize(
    ("module", "method"),
    [
        *(
            pytest.param(*case, marks=pytest.mark.weekly)
            for case in (("own_method", "limit"), ("own_law", "limit_in_python"))
        ),
        ("own_law", "limit_compiled"),
    ],
)
def test_own_method_is_found_by_its_entry_point(
    built_in: Path, tmp_path: Path, module: str, method: str
):
    """A folder on the path with the module and its metadata counts as installed."""
    package = tmp_path / f"{module}-1.0.dist-info"
    package.mkdir()
    (package / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    (package / "entry_points.txt").write_text(f"[ev_stack.methods]\nasr = {module}\n")
    (tmp_path / f"{module}.py").write_text((EXAMPLES / f"{module}.py").read_text())
    environment = {
        **os.environ,
        "PYTHONPATH": f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}",
    }

    short = [
        "shchur2019",
        "--offline",
        "--no-record",
        "--duration",
        str(DURATION),
        "--method",
        f"asr={method}",
    ]
    limited = [*short, "--set", f"asr.limit={LIMIT}", "--out", str(tmp_path / "limited")]
    calls = (["--list"], limited, [*short, "--out", str(tmp_path / "equal")])
    code = f"from ev_stack.commands.run_scenario import main\nfor words in {calls}: main(words)"
    command = [sys.executable, "-c", code]
    output = subprocess.run(
        command, env=environment, check=True, capture_output=True, text=True
    ).stdout
    assert "Limit the drive torque of every wheel" in output
    assert (
        np.max(
            load(tmp_path / "limited" / "signals.npz").channels["wheel_states.effort.front_left"]
        )
        == LIMIT
    )
    assert signal_hash(load(tmp_path / "equal" / "signals.npz")) == signal_hash(
        load(built_in / "signals.npz")
    )
