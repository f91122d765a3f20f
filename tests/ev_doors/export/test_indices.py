"""An index out of range or x / 0 in an exported law of one's own.

A status, and nothing else of it is touched.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from ev_doors.export.content import Content
from ev_doors.export.program import Program, build_program
from ev_doors.export.targets import TARGETS
from ev_stack.interface.driving import only_run, overrides

LAW = '''
from dataclasses import dataclass
from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, entry, method, parameter, series

@dataclass(frozen=True, slots=True)
class P:
    at: float = parameter(0.0, unit="1", low=-1e9, high=1e9, about="where a torque is kept")
    by: float = parameter(1.0, unit="1", low=-1.0, high=1.0, about="divisor")

@dataclass(slots=True)
class S:
    steps: float = entry(unit="1")
    kept: list[float] = series(5, unit="N m")
    behind: float = entry(7.0, unit="1")

@method("asr", "keeping")
@compilable
def keeping(p: P, s: S, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Writes at any place of its five; min hides infinity."""
    s.steps = s.steps + min(1.0 / p.by / p.by, 1.0)
    s.kept[int(p.at)] = request.drive.front_left
    return WheelTorqueCommand(Wheels(s.steps, s.kept[int(p.at)], s.behind, 0.0), request.brake)
'''
TORQUE = 3.5  # of all wheels [N m]
NOTHING = 1  # status: the first output is none


@pytest.mark.parametrize("target", ["x86_64-linux", "aarch64-linux", "thumbv7em"])
def test_an_index_out_of_range_is_a_status_and_the_step_is_none(target: str, tmp_path: Path):
    """The state stays, so the next step with an index in range goes on from there."""
    words = (TARGETS[target].compiler, *TARGETS[target].emulator[:1])
    if lacking := next((word for word in words if not shutil.which(word)), ""):
        pytest.skip(f"{lacking} is not installed")
    (tmp_path / "keeping.py").write_text(LAW)
    run = only_run("shchur2019", "", overrides(method={"asr": str(tmp_path / "keeping.py")}))
    content = Content(run, only=["asr"], bare=True)
    inputs = [TORQUE] * len(content.inputs)
    names = [tunable.name for part in content.parts for tunable in part.tunables]
    assert names == ["asr.at", "asr.by"]
    with Program(content, build_program(content, TARGETS[target], tmp_path)) as program:
        program.create()
        status, outputs = program.step(inputs)
        assert (status, outputs[:3]) == (0, [1.0, TORQUE, 7.0])
        for index in (5.0, 6.0, 1e3, 1e9, -6.0, -1e9):
            assert program.set_parameter(0, index) == 0
            assert program.step(inputs)[0] == NOTHING
        assert program.set_parameter(0, -1.0) == 0
        assert program.set_parameter(1, 0.0) == 0
        assert program.step(inputs)[0] == NOTHING
        assert program.set_parameter(1, 1.0) == 0
        status, outputs = program.step(inputs)
        assert (status, outputs[:3]) == (0, [2.0, TORQUE, 7.0])
