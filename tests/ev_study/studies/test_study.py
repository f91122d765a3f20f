"""Studies: many runs on worker processes, the same table whatever drives them."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from helpers.patience import PATIENCE
from helpers.schedulers import free_port, process, scheduler_with_two_workers, wait_for_listener
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.parameters.data_file import files_in_config
from ev_stack.recording.outcome import RunFailed
from ev_study.commands.benchmark import run_benchmark
from ev_study.studies.digests import digest_of
from ev_study.studies.driving import drive_cases
from ev_study.studies.run_study import arguments
from ev_study.studies.study import Case, drive_case
from ev_study.studies.workers import (
    Job,
    Workers,
    perform_jobs,
    refuse_other_files,
    refuse_others,
)

pytestmark = pytest.mark.slow

CASES = [
    Case(f"from {speed:g} m/s", "coast_down", (("plant", "initial_speed", speed),), duration=2.0)
    for speed in (10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
]


def last_speed(recording, run) -> dict[str, float]:
    return {"speed": float(recording.channels["twist.longitudinal"][-1])}


def last_speed_once_a_worker_is_lost(recording, run) -> dict[str, float]:
    """All but the first case take as long as it takes until a worker has been killed."""
    lost = Path(os.environ["EV_STACK_TEST_MARK"])
    deadline = time.monotonic() + PATIENCE
    while run.configurations["plant"].parameters.initial_speed != 10.0 and not lost.exists():
        assert time.monotonic() < deadline, "no worker was killed"
        time.sleep(0.01)
    return last_speed(recording, run)


def last_speed_but_once_the_worker_dies(recording, run) -> dict[str, float]:
    """Dies in the middle of the second case, the first time that it is driven by any worker."""
    first = Path(os.environ["EV_STACK_TEST_MARK"])
    if run.configurations["plant"].parameters.initial_speed == 20.0 and not first.exists():
        first.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return last_speed(recording, run)


def signals(results) -> list[tuple[str, str, float]]:
    """Names, hashes and speeds, which may not depend on the worker."""
    return [(result.name, result.signal_hash, result.measured["speed"]) for result in results]


@pytest.fixture(scope="module")
def driven_here() -> list[tuple[str, str, float]]:
    return signals(drive_case(case, last_speed) for case in CASES)


def test_cases_differ_and_are_driven(driven_here):
    """All coast: slower than at their start, in its order, and each run with signals of its own."""
    speeds = [speed for _, _, speed in driven_here]
    assert speeds == sorted(speeds) and all(0.0 < speed < 60.0 for speed in speeds)
    assert len({digest for _, digest, _ in driven_here}) == len(CASES)


def test_a_worker_that_dies_costs_no_results(driven_here, tmp_path, monkeypatch):
    """Workers of this machine: one is killed while it has a case.

    The results are those of this process, in order.
    """
    monkeypatch.setenv("EV_STACK_TEST_MARK", str(tmp_path / "died"))
    heard = []

    def keep(number, result):
        heard.append((number, result.name))

    results = drive_cases(CASES, last_speed_but_once_the_worker_dies, keep, workers=Workers(2))
    assert (tmp_path / "died").exists()
    assert signals(results) == driven_here
    assert sorted(heard) == [(number, case.name) for number, case in enumerate(CASES)]


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 7), st.integers(1, 3))
def test_each_job_gives_its_result_once_whatever_the_number_of_workers(count, workers):
    jobs = [Job(f"job {number}", divmod, (number, 3)) for number in range(count)]
    found = []

    def done(number, result):
        found.append((number, result))

    perform_jobs("jobs", jobs, done, Workers(workers))
    assert sorted(found) == [(number, divmod(number, 3)) for number in range(count)]


def dies(recording, run) -> dict[str, float]:
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_case_that_no_worker_survives_ends_the_study():
    with pytest.raises(RunFailed, match="from 10 m/s: 3 workers were lost with it"):
        drive_cases(CASES[:1], dies, workers=Workers(2))


def test_what_goes_wrong_in_measuring_belongs_to_its_case():
    """One case does not end the study behind hours of driving."""

    def measure(recording, run):
        slow = run.configurations["plant"].parameters.initial_speed == 10.0
        return {"x": recording.channels["unheard_of"]} if slow else last_speed(recording, run)

    first, second = drive_cases(CASES[:2], measure, workers=Workers(2))
    assert (
        first.refused.startswith("KeyError 'unheard_of' (test_study.py, line ")
        and not first.measured
    )
    assert first.signal_hash and not second.refused and second.measured


def test_a_disk_that_is_full_ends_the_study():
    def measure(recording, run):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "signals.npz")

    with pytest.raises(OSError, match="No space left on device"):
        drive_cases(CASES[:1], measure, workers=Workers(1))


KILLED = """
import os, signal, sys
from pathlib import Path
from ev_study.studies.driving import drive_cases
from ev_study.studies.study import Case
from ev_study.studies.workers import Workers

folder = Path(sys.argv[1])

def measure(recording, run):
    folder.with_name(f"worker_{os.getpid()}").touch()
    signal.pause()

cases = [Case(str(n), "coast_down", (("plant", "initial_speed", 10.0 + n),), duration=0.1) for n in range(3)]
drive_cases(cases, measure, workers=Workers(2))
"""


def test_a_study_that_is_killed_leaves_no_workers(tmp_path):
    """Workers end with the process that has started them."""
    study = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path / "out")])
    while len(marks := list(tmp_path.glob("worker_*"))) < 2:
        assert study.poll() is None
        time.sleep(0.01)
    study.kill()
    study.wait()
    while any(is_running(int(mark.name.partition("_")[2])) for mark in marks):
        time.sleep(0.01)


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.weekly
def test_scheduler_with_two_workers_of_which_one_is_lost(driven_here, tmp_path, monkeypatch):
    """A real scheduler and two workers, all processes of their own.

    One worker is killed after the first result.
    """
    lost = tmp_path / "lost"
    monkeypatch.setenv("EV_STACK_TEST_MARK", str(lost))

    def kill(number, result) -> None:
        victim.kill()
        victim.wait()
        lost.touch()

    with scheduler_with_two_workers() as (address, victim):
        results = drive_cases(
            CASES, last_speed_once_a_worker_is_lost, kill, workers=Workers(scheduler=address)
        )
        assert victim.wait() == -signal.SIGKILL
    assert signals(results) == driven_here


@pytest.mark.parametrize("other", ["versions", "digest_of_sources"])
def test_a_worker_with_other_packages_or_sources_is_refused(other):
    """Its rows would be kept as if our text had driven them.

    A checkout of last week has the same version.
    """

    class OneWorker:
        def run(self, function, **arguments):
            found = function(**arguments)
            if function.__name__ != other:
                return {"tcp://a": found}
            return {"tcp://a": {**found, "numpy": "0.1"} if isinstance(found, dict) else "other"}

    with pytest.raises(RunFailed, match=r"^worker tcp://a has (numpy 0\.1|other sources)"):
        refuse_others(OneWorker())


def test_a_file_that_is_another_one_for_a_worker_is_refused(tmp_path, monkeypatch):
    """Its numbers would be of another car.

    A worker on another machine has files of its own, in a folder of its own.
    """
    monkeypatch.chdir(tmp_path)
    there = Path("/elsewhere")
    car = tmp_path / "car.yaml"
    car.write_text("mass: 1600.0")
    for path in ("car.yaml", str(car), str(there / "car.yaml")):
        refuse_other_files("tcp://a", there, {path: digest_of(car)})
        with pytest.raises(
            RunFailed, match=rf"^worker tcp://a has read another {path} than \S*car\.yaml here,"
        ):
            refuse_other_files("tcp://a", there, {path: "another"})
    with pytest.raises(
        RunFailed, match=r"another /elsewhere/missing.yaml than /elsewhere/missing.yaml here"
    ):
        refuse_other_files("tcp://a", there, {str(there / "missing.yaml"): digest_of(car)})


@pytest.mark.weekly
def test_workers_with_another_map_of_the_same_name(tmp_path, monkeypatch):
    """They work in another folder; the map is in the folder of the car that names it.

    With the same one they drive.
    """
    here, there = tmp_path / "here", tmp_path / "there"
    car = files_in_config("vehicles")["layout_1_8_c"]
    text = car.read_text().replace("      motor:\n", "      motor:\n        map_file: map.csv\n")
    for folder in (here, there):
        folder.mkdir()
        (folder / "car.yaml").write_text(text)
        shutil.copy(car.parents[1] / "efficiency_maps" / "yasa_400.csv", folder / "map.csv")
    monkeypatch.chdir(here)
    cases = [Case("own car", "coast_down", duration=1.0, vehicle="car.yaml")]
    with scheduler_with_two_workers(there) as (address, _):
        (driven,) = drive_cases(cases, last_speed, workers=Workers(scheduler=address))
        assert not driven.refused
        with (here / "map.csv").open("a") as file:
            file.write("# another one\n")
        with pytest.raises(
            RunFailed, match=r"^worker tcp://127\.0\.0\.1:\d+ has read another \S+map\.csv than"
        ):
            drive_cases(cases, last_speed, workers=Workers(scheduler=address))


def test_no_scheduler_at_that_address(monkeypatch):
    monkeypatch.setattr("ev_study.studies.workers._PATIENCE", 0.5)
    with pytest.raises(RunFailed, match="cannot be reached"):
        drive_cases(CASES[:1], last_speed, workers=Workers(scheduler="tcp://127.0.0.1:9"))


@pytest.mark.parametrize("read", [partial(arguments, "compare"), run_benchmark])
def test_workers_here_and_elsewhere_are_refused_together(read, capsys):
    """The number of workers of a scheduler is its own."""
    with pytest.raises(SystemExit):
        read(["--scheduler", "tcp://127.0.0.1:9", "--workers", "2"])
    assert "--workers: not allowed with argument --scheduler" in capsys.readouterr().err


def test_scheduler_without_workers(monkeypatch):
    monkeypatch.setattr("ev_study.studies.workers._PATIENCE", 3.0)
    address = f"tcp://127.0.0.1:{free_port()}"
    port = address.rpartition(":")[2]
    with process(
        "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"
    ):
        wait_for_listener(int(port))
        with pytest.raises(RunFailed, match="has no workers"):
            drive_cases(CASES[:1], last_speed, workers=Workers(scheduler=address))


@pytest.mark.parametrize(
    ("case", "line"),
    [
        (Case("a", "coast_down", (("plant", "initial_speed", 1e9),)), "initial_speed"),
        (Case("a", "coast_dawn"), "coast_down"),
        (
            Case("a", "launch_split_mu"),
            "unknown run of launch_split_mu ''; known: fixed_steering, steered",
        ),
        (
            Case("a", "coast_down", (("electronic_differential", "method", "slip_target"),)),
            "rear_left and rear_right",
        ),
    ],
)
def test_a_case_that_cannot_be_driven_says_why_in_one_line(case, line):
    result = drive_case(case, last_speed)
    assert line in result.refused and "\n" not in result.refused
    assert not result.measured and not result.signal_hash
