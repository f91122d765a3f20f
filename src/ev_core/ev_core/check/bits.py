"""A law stepped twice with the same signals, compiled and in plain Python: every number must have the same bits."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ev_core.check.inputs import RandomInputs
from ev_core.check.stepping import MakesInputs, frame_of
from ev_core.compiled.loop import call_part
from ev_core.compiled.part import CompiledPart
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.register import create
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import ROLES, RoleKind


def differing_bits(configuration: Configuration, steps: int, seed: int, inputs: MakesInputs = RandomInputs) -> str:
    """What differs first between the compiled and the interpreted form of a configured law; empty if nothing does."""
    method = configuration.method
    settings = (configuration.parameters, configuration.common.vehicle, configuration.common.control_period)
    compiled, plain = CompiledPart(method, *settings), create(method, *settings)
    integrates = ROLES[method.role].kind is RoleKind.INTEGRATES
    given = inputs(method.reads, seed, configuration.common.control_period)
    for step in range(steps):
        signals = given.next()
        here, there = np.array(frame_of(method.reads, signals).numbers), np.zeros(frame.SIZE)
        function, state, constants = compiled.addresses()
        if integrates:
            call_part(function, here.ctypes.data, there.ctypes.data, state, constants)
            plain.advance(*signals)
            said = plain.outputs()
        else:
            there = here
            call_part(function, here.ctypes.data, here.ctypes.data, state, constants)
            answer = plain.step(*signals)
            said = (answer,) if len(method.writes) == 1 else answer
        for signal, kind in zip(said, method.writes, strict=True):
            expected = shape_of(kind).carried(shape_of(kind).flat(signal))
            differing = _differing(there[frame.PLACES[kind]], expected)
            if differing:
                place, values = differing
                return f"step {step}: {kind.__name__}.{shape_of(kind).channels[place]} is {values}"
        # Compiled, a law without a state has one number in its memory.
        differing = _differing(compiled.state[: len(plain.state)], plain.state)
        if differing:
            place, values = differing
            return f"step {step}: number {place} of the state is {values}"
    return ""


def _differing(compiled: ArrayLike, interpreted: ArrayLike) -> tuple[int, str] | None:
    """The first place where the bits differ, and both values there; None if all are the same."""
    pair = [np.asarray(numbers, dtype=float) for numbers in (compiled, interpreted)]
    one, other = (numbers.view(np.int64) for numbers in pair)
    if np.array_equal(one, other):
        return None
    place = int(np.flatnonzero(one != other)[0])
    return place, f"{float(pair[0][place])!r} compiled, {float(pair[1][place])!r} interpreted"
