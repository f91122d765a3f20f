"""Edits reach functions that a user has compiled with numba, here and in new processes."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import pytest
from compiling.edited_law import IMPORTS, REQUEST, method_of
from helpers.compiled_object import CompiledObject

from ev_core.compiling import machine_code
from ev_core.vehicle.description import Vehicle

# By what numba makes: a text that makes `helper`, which takes GAIN from its module.
MADE = {
    "njit": "helper = njit(lambda x: GAIN * x)",
    "jitclass": """
@jitclass([("k", float64)])
class Scaled:
    def __init__(self, k):
        self.k = k
    def get(self):
        return GAIN * self.k
@compilable
def helper(x):
    return Scaled(x).get()
""",
    "njit with types": "helper = njit(float64(float64))(lambda x: GAIN * x)",
    "njit within njit": "inner = njit(lambda x: GAIN * x)\nhelper = njit(lambda x: inner(x))",
    "cfunc": "helper = cfunc(float64(float64))(lambda x: GAIN * x)",
    "vectorize": "helper = vectorize(lambda x: GAIN * x)",
    "vectorize with types": "helper = vectorize([float64(float64)])(lambda x: GAIN * x)",
}
LAW = """
@compilable
def law(request: WheelTorqueRequest) -> WheelTorqueCommand:
    return WheelTorqueCommand(Wheels(helper(request.drive.front_left), 0.0, 0.0, 0.0), request.brake)
"""
MORE = "from dataclasses import make_dataclass\nfrom numba import cfunc, float64, njit, vectorize\n"
PARAMETERS = "P = make_dataclass('P', [('k', float, parameter(1.0, unit='1', about='nothing'))], frozen=True)"


def driven(space: dict[str, Any]) -> float:
    """Command of the compiled law for 3 N m at the front left."""
    made = CompiledObject(method_of(space["law"], space["P"]), space["P"](), Vehicle(), 0.01)
    return float(made.step(REQUEST).drive.front_left)


@pytest.mark.sampled
@pytest.mark.slow
@pytest.mark.parametrize("made", MADE)
def test_a_constant_acts_that_numba_has_frozen(made: str, monkeypatch: pytest.MonkeyPatch):
    """GAIN 1, then 2, each in a new object of the law, and once more from disk.

    Python has called it before.
    """
    module = ModuleType("numba_cells")
    jitclass = "from numba.experimental import jitclass\n"
    exec(
        "\n".join((IMPORTS, MORE, jitclass, "GAIN = 1.0", MADE[made], PARAMETERS, LAW)),
        vars(module),
    )
    space, helper = vars(module), vars(module)["helper"]
    assert helper(3.0) == 3.0
    for gain in (1.0, 2.0):
        space["GAIN"] = gain
        assert driven(space) == 3.0 * gain
        monkeypatch.setattr(machine_code, "_addresses", {})  # as in a new process
        assert driven(space) == 3.0 * gain
