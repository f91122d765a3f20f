"""The campaign that looks for causes of other bits meets them all, and sees a difference."""

import os
from collections import Counter
from pathlib import Path

import pytest
from determinism.__main__ import Found, result_table, tried
from determinism.faults import drawn_changes, run_with
from determinism.surroundings import C_LIBRARIES, COMPILERS, WAYS, drawn
from tqdm import tqdm

from ev_core.faults.fault import KINDS
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash

TOOLS = Path(__file__).parents[3] / "tools"
STEP = ("step_steer", "left", 0.2)
TRIALS = [drawn(trial, 1) for trial in range(20)]


def test_twenty_trials_meet_every_way_compiler_and_c_library_idle_and_busy():
    assert {each.way for each in TRIALS} == set(WAYS)
    assert {each.compiler for each in TRIALS} == set(COMPILERS)
    assert {each.c_library for each in TRIALS} == set(C_LIBRARIES)
    assert {each.busy for each in TRIALS} == {False, True}
    assert len({each.variables["PYTHONHASHSEED"] for each in TRIALS}) == len(TRIALS)


def test_a_seed_draws_the_same_again():
    assert [drawn(trial, 1) for trial in range(20)] == TRIALS


@pytest.mark.parametrize("kind", ["swapped", "restarted", "motor_share"])
def test_kinds_of_faults_take_turns_and_change_what_they_strike(kind):
    """A trial says which, and draws the same again.

    The hash beside it is that of the run with them.
    """
    trial = 2 * list(KINDS).index(kind)
    changes, expected = drawn_changes(*STEP, trial, 1)
    assert kind in {
        text.split()[0] for _, name, texts in changes if name == "faults" for text in texts
    }
    run = run_with(*STEP, changes)
    assert expected == signal_hash(run_offline(run.configurations, run.duration))


def test_a_trial_with_another_hash_is_counted_as_one():
    found = [
        Found("step_steer", 2, Counter({WAYS[0]: 1}), ["step_steer left, trial 1: 00, not 01"])
    ]
    text = result_table(found, 2, 3.0, 1)
    assert text.startswith("1 of 2 trials equal")
    assert "| `step_steer` | 2 | 1 | 0 | 0 | 1 |" in text


@pytest.mark.slow
def test_trials_are_driven_each_in_a_process_of_its_own(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(TOOLS), prepend=os.pathsep)
    found = tried("step_steer", 2, 0.2, 1, tqdm(disable=True))
    assert (found.trials, found.others, dict(found.equal)) == (2, [], dict.fromkeys(WAYS[:2], 1))
