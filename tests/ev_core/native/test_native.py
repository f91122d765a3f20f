"""Laws in C and C++ through the interface of ev_laws.h.

Built with the compiler of this machine, driven, refused.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ev_stack
from ev_core.check.method import check_method
from ev_core.lockstep.configuration import configure
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.simulation import SteppedLaw
from ev_stack.recording.recording import signal_hash
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.scenario import Overrides, load_scenario

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples" / "c_library"
EV_STACK = f"{sys.executable} -c 'from ev_stack.commands.program import main; main()'"
GAMMA = {"electronic_differential.gamma": 7.0}

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """The libraries of the examples, and the header."""
    made = tmp_path_factory.mktemp("build")
    make = ["make", "-C", EXAMPLES, f"BUILD={made}", f"EV_STACK={EV_STACK}"]
    for _ in range(2):
        done = subprocess.run(make, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    return made


@pytest.fixture
def refused(folder, tmp_path):
    """Makes a library with something wrong."""

    def library(*defines: str) -> str:
        source, made = Path(__file__).with_name("refused.c"), tmp_path / "refused.so"
        flags = ["-shared", "-fPIC", f"-I{folder}", "-Wno-unused-const-variable"]
        subprocess.run(
            ["cc", *flags, *(f"-D{each}" for each in defines), "-o", made, source], check=True
        )
        return str(made)

    return library


def test_a_law_in_c_has_the_bits_of_the_law_in_python_offline_and_over_dds(folder, tmp_path):
    library = str(folder / "libpower_steering.so")
    expected = ev_stack.run("shchur2019", set=GAMMA, duration=0.5)
    here = ev_stack.run(
        "shchur2019", method={"electronic_differential": library}, set=GAMMA, duration=0.5
    )
    assert here.hash == expected.hash
    chosen = [
        ("electronic_differential", "method", library),
        ("electronic_differential", "gamma", 7.0),
    ]
    (run,) = load_scenario("shchur2019", Overrides(values=chosen, duration=0.5)).runs
    over_dds = run_in_process(run, tmp_path, False, lambda time: None).recording
    assert {"shchur2019": signal_hash(over_dds)} == {
        name: signal_hash(each) for name, each in expected.runs.items()
    }


@pytest.mark.weekly
def test_a_law_in_c_drives_as_a_process(folder, tmp_path):
    """The runner names it on the node's command line: the node refuses it from a file."""
    library = str(folder / "libpower_steering.so")
    chosen = [
        ("electronic_differential", "method", library),
        ("electronic_differential", "gamma", 7.0),
    ]
    (run,) = load_scenario("shchur2019", Overrides(values=chosen, duration=0.2)).runs
    driven = run_in_processes(run, tmp_path, False, lambda time: None).recording
    expected = ev_stack.run("shchur2019", set=GAMMA, duration=0.2)
    assert [signal_hash(driven)] == [signal_hash(each) for each in expected.runs.values()]


def test_laws_in_c_and_cpp_keep_the_contract(folder):
    check_method("electronic_differential", str(folder / "libpower_steering.so"))
    check_method("asr", str(folder / "libramp_limit.so"), {"limit": 300.0})


def test_the_state_of_a_law_in_cpp_is_kept_and_gone_on_from(folder):
    """The torque rises by at most 2000 N m/s: 20 N m in a period of 10 ms, up to the limit."""
    chosen = {"method": {"asr": str(folder / "libramp_limit.so")}, "set": {"asr.limit": 50.0}}
    car = ev_stack.Simulation("double_lane_change", without=("electronic_differential",), **chosen)
    asked = {"torque_request.drive.front_left": 400.0, "torque_request.brake.rear_left": 7.0}
    frames = [car.step(asked)]
    kept = car.state
    frames += [car.step() for _ in range(3)]
    shown = car.recording.channels
    assert shown["torque_command.drive.front_left"].tolist() == [20.0, 40.0, 50.0, 50.0]
    assert shown["torque_command.brake.rear_left"].tolist() == [7.0] * 4
    car.state = kept
    assert [car.step() for _ in range(3)] == frames[1:]


def test_a_start_and_the_parameters_that_a_library_declares(refused):
    library = refused()
    law = SteppedLaw(configure("asr", {"method": library, "limit": 4.0}))
    assert law.state == [4.0]
    assert (
        law.answer(0.0, {"torque_request.drive.front_left": 3.0})["torque_command.drive.front_left"]
        == 3.0
    )
    assert law.state == [5.0]
    with pytest.raises(
        ParameterError, match=r"^unknown parameter of asr 'limt'; did you mean limit"
    ):
        configure("asr", {"method": library, "limt": 4.0})
    with pytest.raises(
        ParameterError, match=r"^parameter limit: -1\.0 is refused, expected at least 0 N m$"
    ):
        configure("asr", {"method": library, "limit": -1.0})


@pytest.mark.parametrize(
    ("define", "message"),
    [
        (
            "NEWER=1",
            r"asr method \S+: compiled with another ev_laws\.h: layout 0x\w+, here it is 0x\w+; compile it ",
        ),
        (
            "NO_LAW",
            r"asr method \S+: it has no ev_asr, which a law for this role is declared by \(ev_laws\.h\)$",
        ),
        (
            'NAME="lambda"',
            r"asr method \S+: parameter 'lambda' is refused, expected a name of Python's without _ ",
        ),
        (
            'NAME="seed"',
            r"asr method \S+: parameter seed is refused: every node has one of this name, take another$",
        ),
        ("TWICE", r"asr method \S+: parameter 'limit' is refused, expected once$"),
        ("PARAMETERS=NULL", r"asr method \S+: it lacks the table of parameters that it declares$"),
        (
            "LOW=NAN",
            r"asr method \S+: parameter 'limit' needs a name and a finite value between its bounds$",
        ),
    ],
)
def test_a_library_that_does_not_fit_is_refused_when_it_is_loaded(refused, define, message):
    with pytest.raises(ParameterError, match=f"^{message}"):
        configure("asr", {"method": refused(define)})


@pytest.mark.parametrize(
    ("define", "message"),
    [
        (
            "ANSWER=NAN",
            r"at 0 s: asr: WheelTorqueCommand\.drive\.front_left is nan, expected a finite number$",
        ),
        (
            "BRAKE=-2.0",
            r"at 0 s: asr: WheelTorqueCommand\.brake\.rear_left is -2\.0, expected 0 or more$",
        ),
        ("STATUS=3", r"at 0\.03 s: asr: \S+: step returned 3, expected 0$"),
    ],
)
def test_what_a_library_must_not_answer_ends_the_run_in_one_line(refused, define, message):
    with pytest.raises(SignalError, match=f"^{message}"):
        ev_stack.run("double_lane_change", method={"asr": refused(define)}, duration=0.1)


def test_a_brake_torque_of_a_library_that_is_negative_by_rounding_is_none(refused):
    law = {"asr": refused("BRAKE=-1e-17")}
    brake = ev_stack.run("double_lane_change", method=law, duration=0.1).signals[
        "torque_command.brake.rear_left"
    ]
    assert {value.hex() for value in brake.tolist()} == {"0x0.0p+0"}


def answer_of(library: str) -> float:
    """The one torque that a law of `refused.c` lets through, of 3 N m."""
    law = SteppedLaw(configure("asr", {"method": library}))
    return law.answer(0.0, {"torque_request.drive.front_left": 3.0})[
        "torque_command.drive.front_left"
    ]


def test_a_library_is_the_file_that_is_there_now(refused, tmp_path, monkeypatch):
    """A rebuild, and `chdir` under the same text of a path, load the present file."""
    for answer in (1.0, 2.0, 4.0):
        folder = tmp_path / str(answer)
        folder.mkdir()
        shutil.move(refused(f"ANSWER={answer}"), folder / "law.so")
    monkeypatch.chdir(tmp_path / "1.0")
    assert answer_of("law.so") == answer_of("./law.so") == 1.0
    monkeypatch.chdir(tmp_path / "2.0")
    assert answer_of("law.so") == 2.0
    (tmp_path / "4.0/law.so").replace("law.so")
    assert answer_of("law.so") == answer_of("law.so") == 4.0
    os.utime("law.so", ns=(1, 1))  # as an editor leaves it
    with pytest.raises(
        ParameterError,
        match=r"^asr method law\.so: it was written over while it was in use, expected",
    ):
        answer_of("law.so")


def test_a_library_that_is_not_there_or_plays_no_such_role(tmp_path):
    with pytest.raises(ParameterError, match=r"^asr method no\.so: No such file or directory$"):
        configure("asr", {"method": "no.so"})
    with pytest.raises(
        ParameterError, match=r"^plant method a\.so: a library plays one of driver, electronic_diff"
    ):
        configure("plant", {"method": "a.so"})
