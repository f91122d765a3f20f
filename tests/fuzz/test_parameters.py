"""Any value for any parameter: taken over within its range and type, or refused in one line."""

from __future__ import annotations

import math

from fuzz.fuzzing import assert_one_line, fuzzed
from hypothesis import given
from hypothesis import strategies as st

from ev_core.faults.fault import parsed as parsed_faults
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.register import all_methods
from ev_core.parameters.declaration import Entry, entries
from ev_core.parameters.values import ACCEPTED, check, number_of
from ev_msgs_py.refusal import ParameterError
from ev_stack.measures.own_metrics import named_metric

METHODS = [(role, name) for role, methods in all_methods().items() for name in methods]
ENTRIES: dict[tuple[str, str], tuple[Entry, ...]] = {}
numbers = (
    st.floats()
    | st.integers()
    | st.sampled_from([0, -1, 1, 1e308, -1e308, 5e-324, 10**400, 2**63, True])
)
words = st.text(max_size=20) | st.sampled_from(
    ["80 km/h", "1e999 km/h", "nan", "-0", "1 \n m", "inf deg", "³ m", "١ m"]
)
leaves = numbers | words | st.none() | st.binary(max_size=5)
anything = st.recursive(
    leaves, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words, inner, max_size=3)
)


def entries_of(role: str, name: str) -> tuple[Entry, ...]:
    if (role, name) not in ENTRIES:
        method = find_method(role, name)
        ENTRIES[role, name] = (*entries(CommonParameters), *entries(method.parameters))
    return ENTRIES[role, name]


@fuzzed(60, 3.0)
@given(method=st.sampled_from(METHODS), value=anything, data=st.data())
def test_a_value_is_taken_within_its_range_or_refused(method, value, data):
    entry = data.draw(st.sampled_from(entries_of(*method)))
    try:
        taken = check(entry, value)
    except ParameterError as error:
        assert_one_line(error)
        assert entry.name in str(error)
        return
    for element in taken if entry.is_array else (taken,):
        assert type(element) is entry.type
        if entry.type is float:
            assert math.isfinite(element)
        if entry.spec.choices:
            assert element in entry.spec.choices
        assert entry.spec.low is None or element >= entry.spec.low
        assert entry.spec.high is None or element <= entry.spec.high


@fuzzed(15, 1.0)
@given(method=st.sampled_from(METHODS), data=st.data())
def test_several_values_at_once(method, data):
    """Values that fit one by one are refused together in one line, or build something finite."""
    role, name = method
    known = {entry.name: entry for entry in entries_of(role, name)}
    chosen = data.draw(st.lists(st.sampled_from(sorted(known)), min_size=1, max_size=4))
    values = {
        each: data.draw(anything | st.just(known[each].spec.low) | st.just(known[each].spec.high))
        for each in chosen
    }
    try:
        made = configure(role, {"method": name, **values})
    except ParameterError as error:
        assert_one_line(error)
        return
    assert all(math.isfinite(value) for value in made.values().values() if isinstance(value, float))


@fuzzed(30)
@given(text=words, unit=st.sampled_from(sorted(ACCEPTED)))
def test_a_text_with_a_unit_is_a_number_or_none(text, unit):
    number = number_of(text, unit)
    assert number is None or isinstance(number, float)


_FAULT = st.sampled_from(
    [
        "lost",
        "constant",
        "motor_share",
        "imu",
        "wheel_states.velocity.front_left",
        "0.5",
        "nan",
        "from",
        "until",
        "1e400",
    ]
)


@fuzzed(30)
@given(st.lists(_FAULT | words, max_size=7).map(" ".join))
def test_the_text_of_a_fault(text):
    try:
        (fault,) = parsed_faults((text,))
    except ParameterError as error:
        assert_one_line(error)
        return
    assert math.isfinite(fault.value) and 0.0 <= fault.begin < fault.end


@fuzzed(30)
@given(
    st.lists(
        st.sampled_from(["peak", "=", "maximum", "(", ")", "imu.yaw_rate"]) | words, max_size=7
    ).map(" ".join)
)
def test_the_text_of_a_metric(text):
    try:
        assert named_metric(text).name
    except ParameterError as error:
        assert_one_line(error)
