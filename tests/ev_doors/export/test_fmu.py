"""FMUs of a car and its laws in FMPy, in fmusim and in an importer in C.

The numbers of the plain run, to the bit.
"""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ev_stack
from ev_doors.export import targets
from ev_doors.export.fmu import TARGETS as FMU_TARGETS
from ev_doors.export.fmu import VERSIONS, base_unit, place
from ev_doors.export.targets import TARGETS
from ev_stack.commands.program import perform

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "couple_fmus.py"
IMPORTER = Path(__file__).with_name("importer.c")
OF_FMPY = (
    "fmpy",
    "numpy",
    "numpy.libs",
    "lxml",
    "attr",
    "attrs",
    "msgpack",
    "jinja2",
    "markupsafe",
)
# Noise shows whether seeds go along, and a changed gain whether parameters do.
GAIN, TORQUE = "driver.speed_control.proportional_gain", "driver.command.drive_torque"
CHANGED = {GAIN: 300.0, "plant.sensors.imu_yaw_rate.noise": 0.01}
DURATION, PERIOD, ROLE = 0.5, 0.01, "electronic_differential"
STEPS = round(DURATION / PERIOD)
WINE = "/usr/lib/wine/wine64"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def plain():
    return ev_stack.run("shchur2019", set=CHANGED, duration=DURATION).signals


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """An FMU by the words that say what it is; made once."""
    folder, known = tmp_path_factory.mktemp("fmus"), {}

    def fmu(*words: str, on: str = "x86_64-linux", name: str = "car") -> Path:
        file = folder / f"{len(known)}" / f"{name}.fmu"
        if words not in known:
            file.parent.mkdir()
            changed = [
                word for each in CHANGED.items() for word in ("--set", "{}={}".format(*each))
            ]
            what = ["--out", str(file), "--target", on, "--duration", str(DURATION), *changed]
            perform(["fmu", "shchur2019", *what, *words])
            known[words] = file
        return known[words]

    return fmu


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Wine keeps its own things beside ours, not those of the user."""
    return {**os.environ, "WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all"}


@pytest.fixture(params=VERSIONS)
def whole(request, made):
    """The whole graph in one FMU; all cases build it for each system with a compiler here."""
    wanted = FMU_TARGETS if request.config.getoption("--all-cases") else FMU_TARGETS[:1]
    there = [name for name in wanted if shutil.which(TARGETS[name].compiler)]
    return made("--fmi", str(request.param), on=",".join(there), name="whole")


class Instance:
    """An FMU in this process, whatever its version; `calls` are those of FMPy."""

    def __init__(self, file: Path, token: str = "", begins: bool = True) -> None:
        self.described = fmpy.read_model_description(str(file))
        self.is_2 = self.described.fmiVersion == "2.0"
        self.references = {v.name: v.valueReference for v in self.described.modelVariables}
        self.inputs, self.outputs = (
            [v.name for v in self.described.modelVariables if v.causality == kind]
            for kind in ("input", "output")
        )
        self.lines: list[str] = []
        if token:
            self.described.guid = self.described.instantiationToken = token
        self.calls = fmpy.simulation.instantiate_fmu(
            fmpy.extract(str(file)), self.described, logger=self.log
        )
        if begins:
            self.begin()

    def log(self, *words) -> None:
        self.lines.append(words[-1].decode())

    def set_up(self, start: float, stop: float | None = None) -> None:
        if self.is_2:
            self.calls.setupExperiment(startTime=start, stopTime=stop)
            self.calls.enterInitializationMode()
        else:
            self.calls.enterInitializationMode(startTime=start, stopTime=stop)

    def begin(self, start: float = 0.0, stop: float | None = None) -> None:
        self.set_up(start, stop)
        self.calls.exitInitializationMode()

    def get(self, names) -> list[float]:
        call = self.calls.getReal if self.is_2 else self.calls.getFloat64
        return list(call([self.references[name] for name in names]))

    def set(self, names, values) -> None:
        call = self.calls.setReal if self.is_2 else self.calls.setFloat64
        call([self.references[name] for name in names], values)

    def step_from(self, time: float, size: float = PERIOD) -> None:
        self.calls.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def step(self, n: int, size: float = PERIOD) -> list[float]:
        self.step_from(n * PERIOD, size)
        return self.get(self.outputs)


def same_bits(shown, expected) -> bool:
    return np.asarray(shown).tobytes() == np.ascontiguousarray(expected).tobytes()


def test_the_csv_of_fmpy_has_the_bits_of_the_recording(whole, plain, tmp_path):
    result = fmpy.simulate_fmu(str(whole), output=list(plain), stop_time=DURATION)
    fmpy.write_csv(tmp_path / "shown.csv", result)
    with (tmp_path / "shown.csv").open() as file:
        names, *rows = csv.reader(file)
    columns = dict(zip(names, np.array(rows, float).T, strict=True))
    assert [name for name in plain if not same_bits(columns[name], plain[name])] == []


def test_the_csv_of_fmusim_has_the_numbers_of_the_recording(whole, plain, tmp_path):
    """Modelica's importer in C; it writes 16 digits."""
    if not shutil.which("fmusim"):
        pytest.skip("fmusim is not installed")
    shown = tmp_path / "shown.csv"
    words = [
        "fmusim",
        "--stop-time",
        str(DURATION),
        "--output-interval",
        str(PERIOD),
        "--output-file",
        shown,
        whole,
    ]
    subprocess.run(words, check=True, capture_output=True)
    with shown.open() as file:
        names, *rows = csv.reader(file)
    columns = dict(zip(names, zip(*rows, strict=True), strict=True))
    for name, signal in plain.items():
        assert columns[name] == tuple(f"{value:.16g}" for value in signal), name


@pytest.mark.parametrize(
    "target",
    [FMU_TARGETS[0], *(pytest.param(name, marks=pytest.mark.weekly) for name in FMU_TARGETS[1:])],
)
def test_an_importer_in_c_gets_the_bits_of_the_recording(
    whole, plain, target, environment, tmp_path
):
    """Two instances take turns, and a third one goes on from the first one's state as bytes."""
    on = TARGETS[target]
    emulator = (WINE,) if on.system == "Windows" else on.emulator
    for needed in (on.compiler, *emulator[:1]):
        if not shutil.which(needed):
            pytest.skip(f"{needed} is not installed")
    described = fmpy.read_model_description(str(whole))
    outputs = [v.name for v in described.modelVariables if v.causality == "output"]
    version = int(described.fmiVersion[0])
    importer = on.program([IMPORTER], tmp_path / "importer.exe", ["-std=gnu99"])
    library = Path(fmpy.extract(str(whole))) / place("whole", version, target)
    first = described.modelVariables[1].valueReference  # after the time: there are no inputs
    words = [
        library,
        version,
        described.guid or described.instantiationToken,
        first,
        len(outputs),
        STEPS,
        PERIOD,
    ]
    done = subprocess.run(
        [*emulator, importer, *map(str, words)], capture_output=True, env=environment
    )
    assert done.returncode == 0, done.stderr
    shown = np.frombuffer(done.stdout).reshape(STEPS, -1)
    assert [
        name
        for name, column in zip(outputs, shown.T, strict=True)
        if not same_bits(column, plain[name][1:])
    ] == []


def test_car_and_law_coupled_in_a_bare_python_are_the_plain_run(made, plain, tmp_path):
    """Nothing but FMPy and what it needs is there; again and again, and no unpacked FMU is left."""
    bare = tmp_path / "bare"
    bare.mkdir()
    for name in OF_FMPY:
        (bare / name).symlink_to(Path(fmpy.__file__).parents[1] / name)
    car, law = made("--without", ROLE, name="car"), made("--only", ROLE, name="int")
    out = tmp_path / "shown.npz"
    words = [sys.executable, "-S", EXAMPLE, car, law, str(DURATION), out]
    unpacked = tmp_path / "unpacked"
    unpacked.mkdir()
    for _ in range(2):
        done = subprocess.run(
            words,
            capture_output=True,
            text=True,
            env={"PYTHONPATH": str(bare), "TMPDIR": str(unpacked)},
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert list(unpacked.iterdir()) == []
    shown = np.load(out)
    assert set(shown) == set(plain) | {"time"}
    for name, signal in plain.items():
        # the ASR answers behind the law, so one step late
        is_late = name.startswith("torque_command")
        assert same_bits(
            shown[name][1:] if is_late else shown[name], signal[:-1] if is_late else signal
        ), name


def test_a_parameter_that_is_set_before_the_start_is_that_of_another_plain_run(whole, plain):
    other = ev_stack.run("shchur2019", set={**CHANGED, GAIN: 500.0}, duration=DURATION).signals
    assert not same_bits(other[TORQUE], plain[TORQUE])
    one = Instance(whole, begins=False)
    one.set([GAIN], [500.0])
    one.begin()
    assert one.get([GAIN]) == [500.0]
    shown = np.array([one.step(n) for n in range(STEPS)])
    assert [
        name
        for name, column in zip(one.outputs, shown.T, strict=True)
        if not same_bits(column, other[name][1:])
    ] == []


def test_a_parameter_may_change_from_step_to_step(whole, plain):
    """A gain of the driver acts on the next answer while the car pulls away."""
    one, changed = Instance(whole), STEPS - 2
    for n in range(changed):
        one.step(n)
    one.set([GAIN], [500.0])
    assert same_bits(one.get(one.outputs), [plain[name][changed] for name in one.outputs])
    one.step(changed)
    (torque,) = one.get([TORQUE])
    assert torque != plain[TORQUE][changed + 1]


def test_an_input_that_is_set_before_the_start_is_held(made):
    law = Instance(made("--only", ROLE, name="int"), begins=False)
    (name, *_) = law.inputs
    law.set([name], [0.25])
    law.begin()
    assert law.get([name]) == [0.25]


def test_a_step_of_several_periods_is_as_many_steps(whole):
    one, other = Instance(whole), Instance(whole)
    for n in range(4):
        one.step(n)
    assert other.step(0, 4 * PERIOD) == one.get(one.outputs)


def test_the_descriptions_are_valid_and_complete(whole, made):
    for file in (whole, made("--only", ROLE, name="int")):
        assert validate_fmu(str(file)) == []
    law = fmpy.read_model_description(str(made("--only", ROLE, name="int")))
    inputs = {v.name.partition(".")[0] for v in law.modelVariables if v.causality == "input"}
    assert {"driver", "steering_column"} <= inputs
    (gain,) = (v for v in law.modelVariables if v.name == f"{ROLE}.gamma")
    assert (gain.start, gain.min, gain.unit, gain.variability) == ("5.0", "0.0", "1", "tunable")


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (
            lambda it: it.step(0, 1.5 * PERIOD),
            "step size 0.015 s is refused, expected 0.01 s or a multiple of it",
        ),
        (lambda it: it.step(0, 1e17), "step size 1e+17 s is refused"),
        (lambda it: it.set(it.inputs[:2], [0.5, np.nan]), " is refused: not finite"),
        (
            lambda it: it.set([it.inputs[0], it.outputs[0]], [0.5, 0.5]),
            "only inputs and parameters can be set",
        ),
        (lambda it: it.begin(), " between steps is refused, expected before initialization"),
        (
            lambda it: it.calls.exitInitializationMode(),
            "between steps is refused, expected during initialization",
        ),
        (lambda it: it.calls.setFMUState(None), "there is no state"),
        (
            lambda it: it.step(3),
            "a step from 0.03 s is refused, the last one ended at 0 s, 0.03 s from there",
        ),
        (
            lambda it: it.set([f"{ROLE}.gamma"], [-1e9]),
            f"parameter {ROLE}.gamma is refused: out of range",
        ),
        (lambda it: it.calls.deserializeFMUState(bytes(10)), "the bytes are no state of this FMU"),
    ],
)
@pytest.mark.parametrize("fmi", VERSIONS)
def test_what_is_refused_is_one_line_in_the_log_and_changes_nothing(made, fmi, change, line):
    """The name of the law is a word of C."""
    law = Instance(made("--only", ROLE, *(["--fmi", str(fmi)] if fmi != 2 else []), name="int"))
    before = law.get(law.references)
    with pytest.raises(fmpy.fmi1.FMICallException):
        change(law)
    assert [line in each for each in law.lines] == [True]
    assert law.get(law.references) == before


@pytest.mark.weekly
@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_clock_that_adds_its_step_goes_on_for_half_an_hour(made, fmi):
    """1.8 million times 1 ms, which are 3.6e-8 s less than 1800 s then.

    The outputs are of an instant that is one.
    """
    law = Instance(
        made("--only", ROLE, "--set", "*.control_period=0.001", "--fmi", str(fmi), name="int")
    )
    time, period = 0.0, 0.001
    for _ in range(1_800_000):
        law.step_from(time, period)
        time += period
    assert abs(time - 1800.0) > 1e-6 * period
    assert law.get(["time"]) == [1800.0]


@given(
    st.sampled_from(VERSIONS), st.floats(-1e9, 1e9) | st.sampled_from([0.0, 1.7e9, -3e7, 262144.0]),
    st.lists(st.integers(1, 5), min_size=1, max_size=20), st.booleans(),
)  # fmt: skip
@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_every_clock_of_a_master_is_taken_at_any_start_time(made, fmi, start, counts, adds):
    """It adds its step, or multiplies it and takes differences.

    Each step is of one period or of several.
    """
    law = Instance(made("--only", ROLE, "--fmi", str(fmi), name="int"), begins=False)
    law.begin(start)
    done, time = 0, start
    for count in counts:
        done += count
        after = time + count * PERIOD if adds else start + done * PERIOD
        law.step_from(time, count * PERIOD if adds else after - time)
        time = after
    assert law.get(["time"])[0] == pytest.approx(start + done * PERIOD, rel=0, abs=1e-9)
    for wrong in (time + PERIOD, time - PERIOD, time + 0.01 * PERIOD):
        with pytest.raises(fmpy.fmi1.FMICallException):
            law.step_from(wrong)


@pytest.mark.parametrize(
    ("start", "stop", "line"),
    [
        (np.nan, None, "start time nan s is refused, expected one that is finite"),
        (np.inf, None, "start time inf s is refused"),
        (
            1e12,
            None,
            "start time 1e+12 s is refused, expected one that is finite and resolves a hundredth of 0.01 s",
        ),
        (5.0, 4.0, "stop time 4 s is refused, expected 5 s, the start time, or later"),
        (0.0, np.nan, "stop time nan s is refused"),
    ],
)
@pytest.mark.parametrize("fmi", VERSIONS)
def test_times_that_are_none_are_refused(made, fmi, start, stop, line):
    law = Instance(made("--only", ROLE, "--fmi", str(fmi), name="int"), begins=False)
    with pytest.raises(fmpy.fmi1.FMICallException):
        law.set_up(start, stop)
    assert [line in each for each in law.lines] == [True]
    law.begin()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_no_step_goes_beyond_the_stop_time(made, fmi):
    """A step past a stop time that is defined is an error.

    The state is that of before, and may go on to it.
    """
    law = Instance(made("--only", ROLE, "--fmi", str(fmi), name="int"), begins=False)
    law.begin(1.0, 1.0 + 3 * PERIOD)
    law.step_from(1.0, 2 * PERIOD)
    with pytest.raises(fmpy.fmi1.FMICallException, match="status 3"):
        law.step_from(1.0 + 2 * PERIOD, 2 * PERIOD)
    assert law.lines == ["a step to 1.04 s is refused, the stop time is 1.03 s"]
    law.step_from(1.0 + 2 * PERIOD)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_the_order_of_calls_is_that_of_fmi(made, fmi):
    """Initialize, step, terminate.

    A reset leads back to the begin, and a state that was kept into its step.
    """
    law = Instance(made("--only", ROLE, "--fmi", str(fmi), name="int"), begins=False)
    refused = pytest.raises(fmpy.fmi1.FMICallException, match="status 3")
    with refused:
        law.step_from(0.0)
    with refused:
        law.calls.terminate()
    law.set_up(0.0)
    with refused:
        law.step_from(0.0)
    with refused:
        law.set_up(0.0)
    law.calls.exitInitializationMode()
    law.step_from(0.0)
    kept = law.calls.getFMUState()
    law.calls.terminate()
    last = law.get(law.outputs)
    for late in (
        lambda: law.step_from(PERIOD),
        law.calls.terminate,
        lambda: law.set(law.inputs[:1], [0.5]),
    ):
        with refused:
            late()
    assert law.get(law.outputs) == last
    law.calls.setFMUState(kept)
    law.step_from(PERIOD)
    law.calls.freeFMUState(kept)
    law.calls.reset()
    with refused:
        law.step_from(0.0)
    law.begin(7.0)
    law.step_from(7.0)
    assert law.lines[0] == "a step before initialization is refused, expected between steps"
    assert law.lines[-2] == "setting values after the end is refused"


def test_a_description_of_another_fmu_gets_no_instance(made):
    with pytest.raises(Exception, match="Failed to instantiate"):
        Instance(made("--only", ROLE, name="int"), token="{0}")


@pytest.mark.parametrize(
    ("unit", "base"),
    [
        ("N m/rad", {"kg": 1, "m": 2, "s": -2, "rad": -1}),
        ("W/(N m)^2", {"kg": -1, "m": -2, "s": 1}),
        ("N m/(rad s)", {"kg": 1, "m": 2, "s": -3, "rad": -1}),
        ("W s^2/rad^2", {"kg": 1, "m": 2, "s": -1, "rad": -2}),
        ("1/s", {"s": -1}),
        ("degC", {"K": 1, "offset": 273.15}),
        ("bit/s", None),
    ],
)
def test_units_are_those_of_si(unit, base):
    assert base_unit(unit) == base


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--out", "9.fmu"], "error: name '9' is refused, expected one of a function in C"),
        (["--out", "a.zip"], "error: a.zip is refused, expected NAME.fmu"),
        (["--only", "brakes"], "error: unknown role 'brakes'; known: "),
        (["--target", "thumbv7em"], "error: unknown target of an FMU 'thumbv7em'; known: "),
    ],
)
def test_wrong_words_get_one_line(words, line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(targets.shutil, "which", lambda name: name)
    with pytest.raises(SystemExit) as ended:
        perform(["fmu", "shchur2019", "--out", "a.fmu", *words])
    assert str(ended.value).startswith(line)
    assert [*tmp_path.iterdir()] == []
