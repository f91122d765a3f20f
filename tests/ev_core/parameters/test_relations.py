"""Relations between parameters hold when a node starts and when one is changed live, alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import pytest
from fuzz.fuzzing import fuzzed
from hypothesis import example, given
from hypothesis import strategies as st

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.methods.register import all_methods
from ev_core.parameters.declaration import Entry, entries
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.stamps import from_seconds
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_nodes.master.real_time import FadingInputs, MasterParameters

# What some laws need of the car or of the period; the first that is accepted is taken.
CARS: tuple[dict[str, Any], ...] = (
    {},
    {"vehicle.driven_wheels": ["rear_left", "rear_right"]},
    {"vehicle.driven_wheels": list(WHEEL_NAMES)},
    {"vehicle.gear_ratio": 7.4, "control_period": 0.005},
)
METHODS = [(role, name) for role, methods in all_methods().items() for name in methods]
BASES: dict[tuple[str, str], tuple[dict[str, Any], Configuration]] = {}


def base_of(role: str, name: str) -> tuple[dict[str, Any], Configuration]:
    """Return the least settings of a method, and its configuration."""
    if (role, name) not in BASES:
        for car in CARS:
            try:
                BASES[role, name] = car, configure(role, {"method": name, **car}, extra_of(role))
                break
            except ParameterError:
                continue
    return BASES[role, name]


def extra_of(role: str) -> type | None:
    return MasterParameters if role == MASTER else None


def related(of: Any, prefix: str = "") -> Iterator[tuple[Entry, ...]]:
    """The parameters of each group that checks them together, with all groups in it."""
    if "__post_init__" in vars(type(of)):
        yield entries(of, prefix)
    for field in fields(of):
        if is_dataclass(inner := getattr(of, field.name)):
            yield from related(inner, f"{prefix}{field.name}.")


def groups_of(configuration: Configuration) -> list[tuple[Entry, ...]]:
    extra = configuration.extra
    beside = (
        [] if extra is None else [tuple(e for e in entries(extra) if e.name.startswith("command_"))]
    )
    of = (
        *related(configuration.parameters),
        *related(configuration.common),
        *related(configuration.sensors, "sensors."),
    )
    return [*beside, *of] or [entries(configuration.common)]


def values_of(entry: Entry) -> st.SearchStrategy[Any]:
    """Values that are allowed by themselves, often at an end of the range."""
    spec, default = (
        entry.spec,
        entry.default[0] if entry.is_array and entry.default else entry.default,
    )
    if spec.choices:
        one: Any = st.sampled_from(spec.choices)
    elif entry.type is bool:
        one = st.booleans()
    elif entry.type is str:
        return st.just(entry.default)
    else:
        low = -1e6 if spec.low is None else spec.low
        high = max(low, 1e6 if spec.high is None else spec.high)
        ends = [entry.type(each) for each in (low, high)] + (
            [default] if isinstance(default, entry.type) else []
        )
        numbers = st.integers(int(low), int(high)) if entry.type is int else st.floats(low, high)
        one = st.sampled_from(ends) | numbers
    return st.lists(one, max_size=4) if entry.is_array else one


def outcome(make: Any) -> Any:
    try:
        return make().values()
    except ParameterError as error:
        return str(error)


@fuzzed(150, 3.0)
@given(st.sampled_from(METHODS), st.data())
def test_what_a_start_refuses_a_live_change_refuses_with_the_same_words(method, data):
    """Accepted values are the same, whichever way they came."""
    role, name = method
    least, base = base_of(role, name)
    group = data.draw(st.sampled_from(groups_of(base)))
    chosen = data.draw(
        st.lists(st.sampled_from(group), min_size=1, max_size=4, unique_by=lambda entry: entry.name)
    )
    values = {entry.name: data.draw(values_of(entry)) for entry in chosen}
    begun = outcome(lambda: configure(role, {"method": name, **least, **values}, extra_of(role)))
    assert outcome(lambda: base.changed(values)) == begun


@pytest.mark.parametrize(("timeout", "period"), [(0.001, 0.01), (0.02, 0.01), (0.1, 0.05)])
def test_a_command_is_not_given_up_within_two_periods(timeout, period):
    """Real time refuses it at the start and live: no torque would act any more."""
    clock = {"mode": "realtime", "control_period": period}
    allowed = f"more than two control periods, {2 * period:g} s"
    message = f"^parameter command_timeout: {timeout:g} is refused, expected {allowed}$"
    with pytest.raises(ParameterError, match=message):
        configure(MASTER, {**clock, "command_timeout": timeout}, MasterParameters)
    with pytest.raises(ParameterError, match=message):
        configure(MASTER, {**clock, "command_timeout": 1.0}, MasterParameters).changed(
            {"command_timeout": timeout}
        )
    assert configure(
        MASTER, {"control_period": period, "command_timeout": timeout}, MasterParameters
    )


@pytest.mark.parametrize("factor", [0.5, 2.0, 1000.0])
def test_real_time_takes_no_other_pace(factor):
    """It would go by the wall clock all the same; lockstep takes each."""
    clock = {"mode": "realtime", "control_period": 0.01}
    message = f"^parameter real_time_factor: {factor:g} is refused, expected 1 in real time, or mode lockstep$"
    with pytest.raises(ParameterError, match=message):
        configure(MASTER, {**clock, "real_time_factor": factor}, MasterParameters)
    for taken in (0.0, 1.0):
        begun = configure(MASTER, {**clock, "real_time_factor": taken}, MasterParameters)
        with pytest.raises(ParameterError, match=message):
            begun.changed({"real_time_factor": factor})
    assert configure(MASTER, {"real_time_factor": factor}, MasterParameters)


@given(st.integers(1, 100).map(lambda n: n / 1000), st.floats(0.0, 1.0), st.floats(0.001, 1.0))
@example(0.01, 0.02, 0.04)
@example(0.01, 0.02, 0.039)
@example(0.01, 0.2, 0.1)
@example(0.045, 0.02, 0.1)
def test_the_torque_of_a_command_that_has_just_come_does_not_fade(period, ramp, timeout):
    """A command in time is under two periods old at the end of its step; to a nanosecond."""
    clock = {
        "mode": "realtime",
        "control_period": period,
        "command_timeout": timeout,
        "command_ramp": ramp,
    }
    try:
        extra = configure(MASTER, clock, MasterParameters).extra
    except ParameterError as error:
        assert timeout - ramp < 2.0 * period + 1e-9
        assert str(error).startswith(("parameter command_ramp: ", "parameter command_timeout: "))
        return
    held, step = FadingInputs((WheelTorqueCommand,)), from_seconds(period)
    held.take(WheelTorqueCommand, 0, [100.0] * 8, step)
    assert held.share(step, step, extra) == 1.0


@pytest.mark.parametrize(("role", "name"), METHODS)
def test_no_list_of_a_method_can_be_emptied(role, name):
    """Neither alone nor with those of as many elements beside it: a method looks into each.

    ROS has no type for an empty list either, so a node would keep the default.
    """
    _, base = base_of(role, name)
    lists = [each for each in entries(base.method.parameters) if each.is_array and each.default]
    for entry in lists:
        group = entry.name.rpartition(".")[0]
        beside = [
            each.name
            for each in lists
            if each.name.rpartition(".")[0] == group and len(each.default) == len(entry.default)
        ]
        for emptied in ([entry.name], beside):
            with pytest.raises(ParameterError):
                base.changed(dict.fromkeys(emptied, ()))
