"""Faults of signals in the frame: what readers get takes the place of the numbers, once per control period.

A row of numbers holds what the faults behind one object are told, another one what lasts between periods:

    constants  total  size of the state  entries  period [s]  then for each entry the numbers from KIND to OTHER_ROUNDS
    state      for each entry that remembers: whether it has begun, then the numbers
"""

from __future__ import annotations

from collections.abc import Sequence

from ev_core.elementary import cos, sin
from ev_core.faults.fault import OF_SIGNALS
from ev_core.sensors.measuring import Numbers, carried
from ev_core.sensors.random_numbers import WORD, normals, philox, uniform
from ev_core.vehicle.car import GRAVITY
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.frame import TIME

CONSTANT, SCALED, OFFSET, NOISY, TILTED, SWAPPED, FROZEN, LOST, DELAYED, REORDERED, RESTARTED = range(len(OF_SIGNALS))

# What an entry, one fault of one number, is told. OTHER is the place of the number that it is swapped with, NUMBER its
# own among those of the fault, MEMORY where the state has what it remembers, LENGTH numbers. A message carries PLACE in
# single precision if it ROUNDS.
WIDTH = 13
KIND, PLACE, OTHER, BEGIN, END, VALUE, SEED, NAME, NUMBER, MEMORY, LENGTH, ROUNDS, OTHER_ROUNDS = range(WIDTH)
HEAD = 4

# The last word of the counter says what a random number is for; sensors have 0 and 1.
FOR_NOISE, FOR_LOSS = 2, 3


@compilable
def strike(frame: Numbers, state: Numbers, faults: Sequence[float]) -> None:
    """Let all faults do what they do to the numbers in a frame, one after the other."""
    period = int(frame[TIME] / faults[3] + 0.5)
    for n in range(int(faults[2])):
        begin = HEAD + n * WIDTH
        suffer(frame, state, faults[begin : begin + WIDTH], period)


@compilable
def suffer(frame: Numbers, state: Numbers, c: Sequence[float], period: int) -> None:
    """One fault of one number."""
    place, kind, value = int(c[PLACE]), c[KIND], c[VALUE]
    is_on = c[BEGIN] <= period < c[END]
    true = frame[place]
    if c[LENGTH] > 0.0:
        shown = remembered(state, c, period, is_on, true)
        frame[place] = shown if is_on else true
        return
    if not is_on:
        return
    if kind == SWAPPED:
        other = int(c[OTHER])
        frame[place], frame[other] = carried(frame[other], c[ROUNDS]), carried(true, c[OTHER_ROUNDS])
        return
    shown = value
    if kind == SCALED:
        shown = true * value
    elif kind == OFFSET:
        shown = true + value
    elif kind == NOISY:
        w0, w1, w2, w3 = words(c, period, int(c[NUMBER]), FOR_NOISE)
        normal, _ = normals(w0, w1, w2, w3)
        shown = true + value * normal
    elif kind == TILTED:
        shown = true * cos(value) + GRAVITY * sin(value)
    frame[place] = carried(shown, c[ROUNDS])


@compilable
def remembered(state: Numbers, c: Sequence[float], period: int, is_on: bool, true: float) -> float:
    """What a fault shows that knows earlier numbers, and remembers this one."""
    begun, length, kind = int(c[MEMORY]), int(c[LENGTH]), c[KIND]
    memory = begun + 1
    if state[begun] == 0.0:
        state[begun] = 1.0
        for age in range(length):
            state[memory + age] = true
    if kind == DELAYED:
        here = memory + period % length
        shown = state[here]
        state[here] = true
        return shown
    if kind == REORDERED:
        # The first of a pair comes when the second one is expected, and the second one before it, unheeded.
        shown = state[memory]
        state[memory] = true
        return shown if is_drawn(c, period // 2) else true
    if not is_on or (kind == LOST and not is_drawn(c, period)):
        state[memory] = true
    return state[memory]


@compilable
def words(c: Sequence[float], period: int, block: int, purpose: int) -> tuple[int, int, int, int]:
    """Four random words of a fault in a period; the key is the seed and the text of the fault."""
    return philox(period & WORD, period >> 32, block, purpose, int(c[SEED]), int(c[NAME]))


@compilable
def is_drawn(c: Sequence[float], period: int) -> bool:
    """Whether it happens in a period, to all numbers of the fault at once, with the probability that its value is."""
    w0, w1, _, _ = words(c, period, 0, FOR_LOSS)
    return uniform(w0, w1) < c[VALUE]
