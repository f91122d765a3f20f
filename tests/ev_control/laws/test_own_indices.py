"""Our own laws, once with the checks that laws of others always have.

No index leaves its row, no brake pulls.
"""

from __future__ import annotations

import numpy as np
import pytest

from documentation.own_methods import own_methods
from ev_core.check.stepping import Subject, outputs
from ev_core.compiled import part_source
from ev_core.compiled.part import CompiledPart
from ev_core.lockstep.configuration import Configuration, configure
from ev_core.lockstep.finding import find_method
from ev_msgs_py.contract.roles import ROLES

STEPS = 400  # of random numbers and launches
SEED = 1
FRONT = {"vehicle.driven_wheels": ["front_left", "front_right"], "control_period": 0.005}
REAR = {"vehicle.driven_wheels": ["rear_left", "rear_right"]}
ALL = {"vehicle.driven_wheels": ["front_left", "front_right", "rear_left", "rear_right"]}
# Laws of other sources need these drives.
VALUES = {"circuits_on_can": FRONT, "can": FRONT | {"gear_ratio": 2.65}}
VALUES |= {"slip_target": REAR, "wheel_speed": REAR, "axle_redistribution": ALL}
SOME = [("asr", "off"), ("asr", "pi_slip")]  # of which each takes seconds to compile
METHODS = [(role, name) for role in ROLES for name in own_methods(role)]
WITH_OPTIONS = [each for each in METHODS if find_method(*each).switches]


def stepped(configuration: Configuration) -> np.ndarray:
    """Outputs to random numbers and launches."""
    subject = Subject(configuration, True, STEPS)
    part = subject.part()
    assert isinstance(part, CompiledPart)
    assert part.is_checked == (not part_source.OURS)
    return outputs(part, subject.frames(SEED))


def assert_same_with_checks(
    role: str, name: str, monkeypatch: pytest.MonkeyPatch, switches: tuple[str, ...] = ()
) -> None:
    """The same bits in each step.

    An index out of range is a LawError, and a negative brake torque a SignalError.
    """
    values = {"method": name, **VALUES.get(name, {}), **dict.fromkeys(switches, True)}
    configuration = configure(role, values)
    if configuration.method.law is None or not configuration.method.law.is_compilable:
        pytest.skip("it is not compiled")
    before = stepped(configuration)
    monkeypatch.setattr(part_source, "OURS", ())
    monkeypatch.setattr(part_source, "_sources", {})
    assert stepped(configuration).tobytes() == before.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize(("role", "name"), SOME)
def test_some_laws_of_ours_keep_to_their_rows(
    role: str, name: str, monkeypatch: pytest.MonkeyPatch
):
    """Those that most runs have; the others are looked at each week."""
    assert_same_with_checks(role, name, monkeypatch)


@pytest.mark.slow
@pytest.mark.weekly
@pytest.mark.parametrize(("role", "name"), [each for each in METHODS if each not in SOME])
def test_all_laws_of_ours_keep_to_their_rows(role: str, name: str, monkeypatch: pytest.MonkeyPatch):
    """Compiled with checks, laws with thousands of numbers in their state take minutes."""
    assert_same_with_checks(role, name, monkeypatch)


@pytest.mark.slow
@pytest.mark.weekly
@pytest.mark.parametrize(("role", "name"), WITH_OPTIONS)
def test_laws_of_ours_with_all_their_options_keep_to_their_rows(
    role: str, name: str, monkeypatch: pytest.MonkeyPatch
):
    """An option is another function on a longer state, with further signals."""
    assert_same_with_checks(role, name, monkeypatch, find_method(role, name).switches)
