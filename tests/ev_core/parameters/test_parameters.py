"""Parameters as data.

Everything is derived from the field, and what is refused is refused as a whole.
"""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, dataclass
from enum import auto

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_core.methods.register import all_methods
from ev_core.parameters.declaration import Choice, entries, flatten, group, parameter, setting
from ev_core.parameters.values import build, check
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name


@dataclass(frozen=True, slots=True)
class Inner:
    """A group with a relation between its parameters."""

    low: float = parameter(1.0, unit="N m", low=0.0, high=10.0, about="lower limit")
    high: float = parameter(2.0, unit="N m", low=0.0, high=10.0, about="upper limit")

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ParameterError(
                f"low: {self.low!r} is refused, expected at most high = {self.high:g}"
            )


@dataclass(frozen=True, slots=True)
class Middle:
    inner: Inner = group(Inner, high=5.0)
    switch: bool = parameter(False, about="on or off")


@dataclass(frozen=True, slots=True)
class Outer:
    gain: float = parameter(1.0, unit="1", low=-2.0, high=2.0, about="gain", source="a paper")
    count: int = parameter(3, low=1, about="how many")
    name: str = parameter("one", choices=("one", "two"), about="which one")
    text: str = parameter("", about="anything")
    points: tuple[float, ...] = parameter((0.0, 1.0), unit="s", low=0.0, about="points in time")
    switches: tuple[bool, ...] = parameter((), about="switches")
    wheels: tuple[str, ...] = parameter(("left",), choices=("left", "right"), about="wheels")
    middle: Middle = group(Middle)


ENTRIES = {entry.name: entry for entry in entries(Outer)}


def refused(values: dict) -> str:
    """The one line that says why the values are refused."""
    with pytest.raises(ParameterError) as error:
        build(Outer, values)
    text = str(error.value)
    assert "\n" not in text
    return text


def test_groups_become_dotted_names_in_order_of_declaration():
    """ROS parameters are flat: nested keys of a file become dotted names."""
    assert list(ENTRIES) == [
        *("gain", "count", "name", "text", "points", "switches", "wheels"),
        *("middle.inner.low", "middle.inner.high", "middle.switch"),
    ]
    # the group changes the default of its dataclass
    assert ENTRIES["middle.inner.high"].default == 5.0
    assert (ENTRIES["points"].type, ENTRIES["points"].is_array) == (float, True)
    assert (ENTRIES["count"].type, ENTRIES["count"].is_array) == (int, False)
    assert ENTRIES["gain"].spec.source == "a paper"


def test_what_is_not_named_keeps_its_default():
    p = build(Outer, {"middle.inner.low": 3, "points": [5, 6.5], "switches": [True]})
    assert (p.middle.inner, p.points, p.switches) == (Inner(3.0, 5.0), (5.0, 6.5), (True,))
    assert (p.gain, p.count, p.middle.switch) == (1.0, 3, False)
    assert build(Outer, {}) == Outer()


NUMBERS = [
    *((f"float{size}", 0.5) for size in (16, 32, 64)),
    *((f"{sign}int{size}", 1) for size in (8, 16, 32, 64) for sign in ("", "u")),
]


@pytest.mark.parametrize(("kind", "value"), NUMBERS)
def test_a_number_of_numpy_is_a_number(kind, value):
    """Alone, in a list and as an array, as loops over np.arange give them."""
    number = np.dtype(kind).type(value)
    names = ["gain", "count"] if value == 1 else ["gain"]
    made = build(Outer, {**dict.fromkeys(names, number), "points": [number, number]})
    assert (
        build(Outer, {"points": np.array([number, number])}).points == made.points == (value, value)
    )
    assert {type(number) for number in (made.gain, *made.points)} == {float}
    assert (made.gain, made.count, type(made.count)) == (value, 1 if value == 1 else 3, int)


def test_what_numpy_holds_besides_is_taken_or_refused_like_the_same_of_python():
    made = build(
        Outer,
        {
            "middle.switch": np.bool_(True),
            "switches": np.array([True, False]),
            "name": np.str_("two"),
        },
    )
    assert (made.middle.switch, made.switches, type(made.name)) == (True, (True, False), str)
    for value in (
        np.float64(3.0),
        np.float64("nan"),
        np.bool_(True),
        np.array([1.0]),
        np.complex128(1),
        np.array("x"),
    ):
        assert refused({"gain": value}).startswith("parameter gain: ")
    assert (
        refused({"count": np.float64(2.0)})
        == "parameter count: 2.0 is refused, expected a whole number, at least 1"
    )
    assert refused({"points": np.zeros((2, 2))}).startswith(
        "parameter points: [0.0, 0.0] is refused, expected a number"
    )


def test_a_number_becomes_a_float_and_an_array_a_tuple():
    """YAML and ROS give 3 for 3.0 and lists for arrays.

    A frozen dataclass keeps hashable values of one type.
    """
    p = build(Outer, {"gain": 2, "points": [1, 2]})
    assert type(p.gain) is float
    assert [type(point) for point in p.points] == [float, float]
    assert isinstance(hash(p), int)
    with pytest.raises(FrozenInstanceError):
        p.gain = 1.0


@given(
    st.fixed_dictionaries(
        {},
        optional={
            "gain": st.floats(-2, 2),
            "count": st.integers(1, 10**9),
            "text": st.text(st.characters(exclude_characters="\0")),
            "name": st.sampled_from(("one", "two")),
            "points": st.lists(st.floats(0, allow_infinity=False)).map(tuple),
            "wheels": st.lists(st.sampled_from(("left", "right"))).map(tuple),
            "middle.inner.low": st.floats(0, 5),
            "middle.switch": st.booleans(),
        },
    )
)
def test_flatten_is_the_inverse_of_build(values):
    flat = flatten(build(Outer, values))
    assert {name: flat[name] for name in values} == values
    assert build(Outer, flat) == build(Outer, values)
    assert {name: flat[name] for name in flat if name not in values} == {
        name: default for name, default in flatten(Outer()).items() if name not in values
    }


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("gain", "fast", "a number, -2 to 2, or a text of a number and one of %"),
        ("gain", True, "a number, -2 to 2"),
        ("gain", None, "a number, -2 to 2"),
        ("gain", [1.0], "a number, -2 to 2"),
        ("gain", 2.0000001, "-2 to 2"),
        ("gain", -3, "-2 to 2"),
        ("gain", math.nan, "a finite number, -2 to 2"),
        ("gain", math.inf, "a finite number, -2 to 2"),
        ("gain", 10**400, "a finite number, -2 to 2"),
        ("count", 1.0, "a whole number, at least 1"),
        ("count", True, "a whole number, at least 1"),
        ("count", 0, "at least 1"),
        ("name", "three", "one of one, two"),
        ("name", 1, "a text, one of one, two"),
        ("text", 5, "a text, any value of its type"),
        ("text", "a\0b", "a text without the character NUL"),
        ("points", 1.0, "an array of numbers"),
        ("points", "12", "an array of numbers"),
        ("points", b"12", "an array of numbers"),
        ("points", {1.0: 2.0}, "an array of numbers"),
        ("points", [0.0, math.nan], "a finite number, at least 0 s"),
        ("points", [0.0, -1.0], "at least 0 s"),
        ("points", [[0.0]], "a number, at least 0 s"),
        ("switches", [1], "true or false"),
        ("wheels", ["left", "middle"], "one of left, right"),
        ("middle.switch", 1, "true or false"),
        ("middle.inner.low", -1, "0 to 10 N m"),
    ],
)
def test_a_bad_value_is_refused_with_name_value_and_what_is_allowed(name, value, allowed):
    """design.md: the message names the parameter, the value and the allowed range."""
    text = refused({name: value})
    assert text.startswith(f"parameter {name}: ")
    assert text.endswith(f"is refused, expected {allowed}")
    culprit = (
        value[-1]
        if isinstance(value, list) and "array" not in allowed and name != "gain"
        else value
    )
    assert quoted(culprit) in text


@given(st.floats() | st.integers())
def test_both_ends_of_a_range_are_allowed_and_nothing_beyond(value):
    if math.isfinite(value) and -2 <= value <= 2:
        assert check(ENTRIES["gain"], value) == value
    else:
        with pytest.raises(ParameterError):
            check(ENTRIES["gain"], value)


def test_a_relation_is_checked_after_all_values_and_names_the_full_parameter():
    """Both limits may move at once, though each alone would be refused."""
    assert build(Outer, {"middle.inner.low": 8, "middle.inner.high": 9}).middle.inner == Inner(
        8.0, 9.0
    )
    assert (
        refused({"middle.inner.low": 8})
        == "middle.inner.low: 8.0 is refused, expected at most high = 5"
    )


@pytest.mark.parametrize(
    "name", ["gian", "middle", "middle.inner", "middle.inner.low.x", "", "Gain"]
)
def test_an_unknown_name_is_refused_and_the_known_ones_are_listed(name):
    text = refused({name: 1.0})
    assert text.startswith(f"unknown parameter {name!r}; ")
    assert set(text.partition("known: ")[2].split(", ")) == set(ENTRIES)


def test_the_most_similar_names_are_asked_for():
    assert "did you mean gain? known: " in refused({"gian": 1.0})
    assert str(unknown_name("node", "drivr", ["asr", "plant", "driver"])) == (
        "unknown node 'drivr'; did you mean driver? known: asr, driver, plant"
    )
    many = [f"front_{i}" for i in range(30)]
    assert str(unknown_name("wheel", "front7", many)) == (
        "unknown wheel 'front7'; did you mean front_7, front_27, front_17?"
    )
    assert str(unknown_name("wheel", "rear", many)).endswith("front_19 and 18 more")
    assert str(unknown_name("node", 5, [])) == "unknown node 5; known: "


def test_nothing_is_applied_when_one_value_is_refused():
    """The good value beside the bad one leaves no trace, not even in the defaults."""
    before = flatten(Outer())
    refused({"gain": 2.0, "count": 0})
    refused({"gain": 2.0, "unknown": 0})
    refused({"gain": 2.0, "middle.inner.low": 8})
    assert flatten(Outer()) == before


def test_values_under_a_prefix():
    """A group is built by itself when a node takes it out of a larger set of parameters."""
    assert build(Inner, {"limits.low": 2.0}, "limits.") == Inner(2.0, 2.0)
    assert list(flatten(Inner(), "limits.")) == ["limits.low", "limits.high"]
    with pytest.raises(ParameterError, match=r"^limits\.low: 3\.0 is refused"):
        build(Inner, {"limits.low": 3.0}, "limits.")


def test_a_type_that_ros_does_not_know_cannot_be_declared():
    @dataclass(frozen=True)
    class Wrong:
        table: list[float] = parameter(None, about="lists can be changed")

    with pytest.raises(TypeError, match="a tuple of one of them"):
        entries(Wrong)


SETS = {
    "vehicle": Vehicle,
    **{
        f"{role} {name}": method.parameters
        for role, of in all_methods().items()
        for name, method in of.items()
    },
}


@pytest.mark.parametrize("of", SETS.values(), ids=SETS)
def test_every_parameter_of_the_stack_accepts_its_own_default_and_says_its_unit(of):
    """A default out of range would be refused when it is written down.

    A number has a unit, a pure one the unit 1.
    """
    for entry in entries(of):
        assert check(entry, entry.default) == entry.default, entry.name
        assert entry.spec.about, entry.name
        assert entry.spec.unit or entry.type is not float, entry.name


class Written(Choice):
    """Members as users write them: the case of a name is theirs."""

    LARGE = auto()
    small = auto()
    Mixed_one = auto()


@dataclass(frozen=True)
class WithChoice:
    written: Written = setting(Written.LARGE, about="which")


@pytest.mark.parametrize("member", list(Written))
def test_a_member_of_a_choice_is_found_by_its_name_in_small_letters(member):
    assert build(WithChoice, {"written": member.name.lower()}).written is member
