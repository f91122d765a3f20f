"""Faults that are put into a circuit of the bench.

One that is accepted strikes, and changes something.
"""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from ev_bench.inverter.device import Injected
from ev_bench.machines.bus_faults import BusFault, BusFaultParameters, measured, present, put_in
from ev_core.lockstep.configuration import configure
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_msgs_py.refusal import ParameterError

TICKS = 40  # of 1 ms, as long as a test looks
OF_FRAMES = ("lost_frames", "wrong_crc", "wrong_counter", "load_limit")  # whatever their value is
KINDS = [kind.name.lower() for kind in BusFault if kind is not BusFault.NONE]
TIMES = st.floats(0.0, 0.03) | st.integers(0, 30).map(lambda tick: tick / 1000)


@given(st.sampled_from(KINDS), TIMES, TIMES, st.sampled_from([0.0, 1.0, -1.0, 120.0]))
@example("trip", 0.012, 0.01, 0.0)
@example("trip", 0.0102, 0.0104, 0.0)
@example("trip", 0.01, 0.011, 0.0)
@example("hot_winding", 0.01, 0.02, 0.0)
def test_a_fault_is_accepted_where_it_strikes_and_changes_something(kind, begin, end, value):
    """An accepted fault acts in some cycle of 1 ms, with a value that changes something."""
    try:
        parameters = BusFaultParameters(kind, "right", begin, end, value)
    except ParameterError:
        parameters = None
    p = namespace(number_tree(BusFaultParameters()))
    p.kind, p.begin, p.end, p.value = float(BusFault[kind.upper()]), begin, end, value
    strikes = any(present(p, float(tick), 0) for tick in range(TICKS))
    injected = Injected()
    put_in(p, injected, int(p.kind))
    changes = injected != Injected() or measured(p, int(p.kind), 50.0) != 50.0 or kind in OF_FRAMES
    is_limit = kind != "load_limit" or value >= 0.0
    assert (parameters is not None) == (strikes and changes and is_limit)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (
            {"kind": "trip", "begin": 2.0, "end": 1.0},
            "inject.end: 1.0 is refused beside begin 2.0, expected a multiple of 0.001 s from begin on and before end: "
            "the fault would never strike",
        ),
        (
            {"kind": "hot_winding"},
            "inject.value: 0.0 is refused beside kind hot_winding, expected another one: it changes nothing",
        ),
        (
            {"kind": "load_limit", "value": -5.0},
            "inject.value: -5.0 is refused beside kind load_limit, expected 0 or more",
        ),
    ],
)
def test_one_that_cannot_be_is_refused_in_one_line(values, text):
    given_values = {f"inject.{name}": value for name, value in values.items()}
    with pytest.raises(ParameterError) as refused:
        configure("test_bench", {"method": "circuits_on_can", **given_values})
    assert str(refused.value) == text
