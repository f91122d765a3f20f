"""All that lasts between steps is in the state: taken out, put into a new part, the run goes on to the bit."""

from __future__ import annotations

import random
from typing import Any

import pytest

from ev_msgs_py.check.inputs import RandomInputs
from ev_msgs_py.contract.frame import PLACES, TIME, Frame, numbers_of
from ev_msgs_py.contract.shape import shape_of
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.lockstep.configuration import Configuration, configure
from ev_msgs_py.lockstep.methods import all_methods
from ev_msgs_py.lockstep.parts import part_of

STEPS = 60
# Laws of other sources need rear drives, or all four.
DRIVEN = {"slip_target": ["rear_left", "rear_right"], "axle_redistribution": list(WHEEL_NAMES)}
METHODS = [(role, name) for role, methods in all_methods().items() for name in methods]


def configured(role: str, name: str) -> Configuration:
    layout = {"vehicle.driven_wheels": DRIVEN[name]} if name in DRIVEN else {}
    return configure(role, {"method": name, **layout})


def frame_of(configuration: Configuration, signals: tuple[Any, ...]) -> Frame:
    here = Frame()
    for kind, signal in zip(configuration.method.reads, signals, strict=True):
        if kind in PLACES:
            here.numbers[PLACES[kind]] = numbers_of(shape_of(kind).flat(signal))
        else:
            here.numbers[TIME] = signal.time
    return here


def stepped(part: Any, here: Frame) -> bytes:
    """The bytes of all that the part says in one step."""
    given, there = Frame(), Frame()
    given.raw[:] = here.raw
    part.step(given, there)
    return there.raw.tobytes()


@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "interpreted"])
@pytest.mark.parametrize(("role", "name"), METHODS)
def test_a_run_that_is_stopped_saved_and_loaded_goes_on_to_the_bit(role, name, compiled):
    configuration = configured(role, name)
    inputs = RandomInputs(configuration.method.reads, 3, configuration.common.control_period)
    frames = [frame_of(configuration, inputs.next()) for _ in range(STEPS)]
    stop = random.Random(f"{role} {name}").randrange(1, STEPS - 1)
    steady, stopped = (part_of(configuration, compiled) for _ in range(2))
    for here in frames[:stop]:
        stepped(steady, here)
        stepped(stopped, here)
    saved = [float(number) for number in stopped.state] if stopped.state is not None else None
    fresh = part_of(configuration, compiled)
    if saved is not None:
        fresh.state = saved
    assert [stepped(fresh, here) for here in frames[stop:]] == [stepped(steady, here) for here in frames[stop:]]


@pytest.mark.parametrize(("role", "name"), METHODS)
def test_every_number_of_a_state_has_a_name_of_its_own(role, name):
    """It can be compared and read by people: a name for each number, with a unit where it is declared."""
    law = configured(role, name).method.law
    assert law is not None, f"{role} {name} has no declared state"
    names = law.names()
    assert len({*names}) == len(names) == len(part_of(configured(role, name), compiled=False).state)
