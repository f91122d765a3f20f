"""Every fault takes the torque away in time, is named, latched and cleared by the reset alone.

Few seeds of many.

The long form: `python benchmarks/can_faults.py`, 100 seeds each, and `--fuzz 100000`.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

FILE = Path(__file__).parents[3] / "benchmarks" / "can_faults.py"


def loaded():
    spec = importlib.util.spec_from_file_location("can_faults", FILE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


trials = loaded()


@pytest.fixture(scope="module")
def ready():
    return trials.enabled_rig()


@pytest.mark.parametrize("what", trials.FAULTS)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_fault_ends_the_torque_in_time_and_is_latched_by_name(ready, what: str, seed: int):
    cycles, wrong = trials.trial(ready, trials.FAULTS[what], seed)
    assert not wrong
    assert cycles <= trials.FAULTS[what].limit


def test_without_a_fault_the_torque_stays(ready):
    """Trials show something only if the torque stays without a fault."""
    nothing = trials.Fault(lambda rig, name, chance: None, "Trip")
    assert trials.trial(ready, nothing, 1)[1] == "the torque stays"


def test_a_twin_goes_on_to_the_bit(ready):
    """All that lasts is declared.

    A rig that is made from the numbers of another one says the same from then on.
    """
    one, other = ready.twin(), ready.twin()
    for rig in (one, other):
        rig.torque = {"Drive11": 70.0, "Drive12": -30.0}
    for _ in range(60):
        one.tick()
        other.tick()
        assert one._sent == other._sent
    assert one.inverter("Drive11").torque == other.inverter("Drive11").torque > 69.0


def test_random_frames_at_both_ends_move_nothing():
    assert trials.fuzz(1500) == ""
