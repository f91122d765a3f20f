"""Examples in the docstrings of what a program calls do what they show."""

from __future__ import annotations

import doctest

import pytest

import ev_stack
import ev_study
from ev_core.law import entry, parameter
from ev_core.methods import register
from ev_doors.learning.environment import Environment


def failures_of(called: object) -> int:
    """Run the examples of a docstring, and return how many of them fail."""
    names = {"__name__": "example", called.__name__: called}
    examples = doctest.DocTestFinder(recurse=False).find(called, called.__name__, globs=names)
    runner = doctest.DocTestRunner()
    for each in examples:
        runner.run(each)
    assert runner.tries > 0
    return runner.failures


@pytest.mark.parametrize(
    "called",
    [
        ev_stack.run,
        ev_stack.batch,
        ev_stack.Simulation,
        ev_stack.Result.plot,
        parameter,
        entry,
        ev_study.compare,
        ev_study.sweep,
        Environment,
    ],
    ids=lambda called: called.__name__,
)
def test_an_example_gives_what_it_shows(called):
    assert failures_of(called) == 0


def test_the_law_of_an_example_is_a_method():
    """It is private to its example, so the register stays as it is."""
    failed = []
    made = register.registered_by("example", lambda: failed.append(failures_of(register.method)))
    assert failed == [0]
    assert list(made["electronic_differential"]) == ["front_halves"]
