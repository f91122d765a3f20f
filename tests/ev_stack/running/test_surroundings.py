"""Commands in surroundings that are unlike a developer's terminal.

No home folder, closed streams, an early Ctrl-C.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.run_script import ENVIRONMENT, ROOT, RUN

from ev_core.compiling.user_cache import cache_folder
from ev_stack.running.domain import free_domain

pytestmark = pytest.mark.slow

COMMAND = ROOT / "scripts" / "ev-stack"
SHORT = ("shchur2019", "--duration", "0.1", "--no-report")
# A folder that cannot be made, for root as well.
HOMELESS = {**ENVIRONMENT, "HOME": "/dev/null/none", "EV_STACK_CACHE": str(cache_folder())}


@pytest.mark.parametrize(
    "way",
    [
        pytest.param(("--offline",), marks=pytest.mark.weekly),
        pytest.param(("--in-process",), marks=pytest.mark.weekly),
        (),
    ],
    ids=["offline", "one process", "processes"],
)
def test_a_run_needs_no_home_folder(way: tuple[str, ...], tmp_path: Path):
    """ROS would make ~/.ros/log, which containers and system users cannot."""
    done = subprocess.run(
        [RUN, *SHORT, *way, "--out", tmp_path], env=HOMELESS, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "summary.json").read_text())["signal_hash"]


def test_a_command_in_the_graph_needs_no_home_folder():
    """The line names the missing graph, not the missing home folder."""
    with free_domain() as domain:
        environment = {**HOMELESS, "ROS_DOMAIN_ID": str(domain)}
        done = subprocess.run(
            [COMMAND, "param", "get", "plant"], env=environment, capture_output=True, text=True
        )
    assert done.stderr.startswith("error: no nodes are running in ROS domain"), done.stderr


@pytest.mark.sampled
@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize("program", ["run", "ev-stack"])
def test_a_command_with_closed_streams_does_what_it_is_asked_for(
    program: str, closed: str, tmp_path: Path
):
    start = str(RUN) if program == "run" else f"{COMMAND} run"
    line = f"{start} {' '.join(SHORT)} --offline --out {tmp_path / 'out'} {closed}"
    done = subprocess.run(["bash", "-c", line], env=ENVIRONMENT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert (tmp_path / "out" / "summary.json").exists()


def test_a_refusal_with_closed_streams_keeps_its_status():
    assert (
        subprocess.run(
            ["bash", "-c", f"{COMMAND} run no_such_scenario 2>&-"], env=ENVIRONMENT
        ).returncode
        == 1
    )


INTERRUPT_WHILE = """
import os, signal, sys
from importlib.abc import MetaPathFinder

class Interrupt(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == os.environ["WHILE_IMPORTING"]:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupt())
"""
# Modules of each stage: Python's own start, the entry point, the command's module, what that
# imports when it works.
STAGES = {
    "list": ("importlib.metadata", "ev_stack.commands.program", "ev_stack.commands.run_scenario"),
    "dashboard": (
        "ev_nodes.stepping.stop_request",
        "ev_doors.commands.dashboard",
        "rclpy",
        "tornado",
    ),
    "schema": ("ev_stack.commands.descriptions", "numpy"),
}


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("command", "module"), [(name, each) for name, stages in STAGES.items() for each in stages]
)
def test_ctrl_c_at_any_stage_of_a_start_is_one_line(command: str, module: str, tmp_path: Path):
    """The signal comes in an import, so no stage depends on the speed of the machine."""
    (tmp_path / "sitecustomize.py").write_text(INTERRUPT_WHILE)
    environment = {**ENVIRONMENT, "PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}"}
    environment["WHILE_IMPORTING"] = module
    words = [
        COMMAND,
        command,
        *(["shchur2019", "--out", tmp_path / "out"] if command == "dashboard" else []),
    ]
    done = subprocess.run(
        words,
        env=environment,
        capture_output=True,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert (done.returncode, done.stderr) == (130, "stopped\n"), done.stdout[-300:]


def test_python_of_the_environment_starts_in_the_c_locale():
    """The file with the paths of the packages is ASCII whatever the checkout is called."""
    paths = [
        Path(each) / "ev_stack.pth" for each in sys.path if (Path(each) / "ev_stack.pth").exists()
    ]
    assert all(path.read_bytes().isascii() for path in paths)


def test_a_working_directory_that_was_deleted_is_one_line_of_ours(tmp_path: Path):
    """Bash adds lines of its own before it reads the script."""
    line = f'cd "$0" && rmdir "$0" && {RUN} shchur2019 --offline'
    (tmp_path / "gone").mkdir()
    done = subprocess.run(
        ["bash", "-c", line, tmp_path / "gone"], env=ENVIRONMENT, capture_output=True, text=True
    )
    ours = [each for each in done.stderr.splitlines() if "getcwd" not in each]
    assert (done.returncode, ours) == (
        1,
        ["error: the working directory was deleted, expected one that exists"],
    )
