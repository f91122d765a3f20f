"""An exported program takes no negative brake torque, as a run takes none."""

from __future__ import annotations

import math
import shutil

import fmpy
import pytest
from fmpy.simulation import instantiate_fmu
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_doors.export.content import Content
from ev_doors.export.library import low_of
from ev_doors.export.program import Program, build_program
from ev_doors.export.targets import TARGETS
from ev_msgs_py.contract.fields import NEGLIGIBLE
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.program import perform
from ev_stack.interface.driving import only_run, overrides
from ev_stack.interface.simulation import SteppedLaw

pytestmark = pytest.mark.slow

ROLE = "asr"  # which hands brake torques on without traction control
OUT_OF_RANGE = -3
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from(
    (-0.0, -5e-324, -1e-17, -NEGLIGIBLE, math.nextafter(-NEGLIGIBLE, -1.0), -50.0, -1.7e308)
)


@pytest.fixture(scope="module")
def content() -> Content:
    return Content(
        only_run("shchur2019", "", overrides(method={ROLE: "off"})), only=[ROLE], bare=True
    )


@pytest.fixture(scope="module", params=["x86_64-linux", "thumbv7em"])
def program(request, content, tmp_path_factory):
    target = TARGETS[request.param]
    words = (target.compiler, *target.emulator[:1])
    if lacking := next((word for word in words if not shutil.which(word)), ""):
        pytest.skip(f"{lacking} is not installed")
    with Program(
        content, build_program(content, target, tmp_path_factory.mktemp("signs"))
    ) as running:
        yield running


@settings(deadline=None, max_examples=100)
@given(data=st.data(), number=NUMBERS)
def test_a_program_takes_no_negative_brake_torque(content, program, data, number):
    """Leftovers of rounding are 0.

    Lower values are out of range and change nothing. Drive torques may be negative.
    """
    names = [channel.name for channel in content.inputs]
    name = data.draw(st.sampled_from([name for name in names if "torque_request" in name]))
    is_brake = ".brake." in name
    assert [each.name for each in content.inputs if low_of(each) == 0.0] == [
        each for each in names if ".brake." in each
    ]
    assert program.create()[0] == 0
    before = program.state
    status, outputs = program.step([number if each == name else 0.0 for each in names])
    if is_brake and number < -NEGLIGIBLE:
        assert status == OUT_OF_RANGE
        assert program.state == before
        return
    assert status == 0
    answered = dict(zip([channel.name for channel in content.outputs], outputs, strict=True))
    given_on = answered[name.replace("torque_request", "torque_command")]
    assert given_on.hex() == (0.0 if is_brake and number < 0.0 else number).hex()


@pytest.mark.parametrize("version", ["2", "3"])
def test_an_fmu_takes_no_negative_brake_torque(version, tmp_path):
    """It declares the bound and discards such a value with one line in its log."""
    file = tmp_path / "law.fmu"
    words = [
        "--only",
        ROLE,
        "--method",
        f"{ROLE}=off",
        "--target",
        "x86_64-linux",
        "--fmi",
        version,
    ]
    perform(["fmu", "shchur2019", "--out", str(file), *words])
    described = fmpy.read_model_description(str(file))
    (brake,) = (v for v in described.modelVariables if v.name == "torque_request.brake.rear_left")
    assert float(brake.min) == 0.0
    lines: list[str] = []
    unit = instantiate_fmu(
        fmpy.extract(str(file)), described, logger=lambda *words: lines.append(words[-1].decode())
    )
    put, get = (
        (unit.setReal, unit.getReal) if version == "2" else (unit.setFloat64, unit.getFloat64)
    )
    with pytest.raises(fmpy.fmi1.FMICallException):
        put([brake.valueReference], [-0.5])
    assert lines == [f"input {brake.name} is refused: out of range"]
    put([brake.valueReference], [-1e-17])
    assert list(get([brake.valueReference])) == [0.0]
    unit.freeInstance()


def test_a_law_that_is_stepped_alone_takes_none(content):
    law = SteppedLaw(content.run.configurations[ROLE])
    with pytest.raises(
        ParameterError,
        match=r"^input torque_request.brake.front_left: .*-0\.5.* expected 0 or more$",
    ):
        law.answer(0.0, {"torque_request.brake.front_left": -0.5})
