"""Rules between parameters hold in an export.

What it lets change on its own, a run takes in every combination.
"""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.compiled.part import given_to
from ev_core.compiled.part_source import constants_row
from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.record import numbers
from ev_doors.export.content import Content, Tunable
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.driving import only_run, overrides
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import Run, load_scenario

_LARGE = 1e6  # in the place of a bound that there is not


@cache
def methods() -> dict[tuple[str, str], Run]:
    """A run with each method that there is in the scenarios, and with laws that have rules."""
    runs = [run for name in scenario_names() for run in load_scenario(name).runs]
    for role, method in (
        ("electronic_differential", "direct_yaw_moment"),
        ("asr", "least_squares"),
        ("asr", "slip_window"),
    ):
        runs.append(only_run("urban_mixed", "", overrides(method={role: method})))
    return {
        (role, each.method.name): run for run in runs for role, each in run.configurations.items()
    }


@cache
def tunables(role: str, method: str) -> tuple[Tunable, ...]:
    """Parameters that may change in an export of this role; none where there is no such export."""
    try:
        content = Content(methods()[role, method], only=[role], bare=True)
    except ParameterError:
        return ()
    return tuple(tunable for part in content.parts for tunable in part.tunables)


@pytest.mark.weekly
@given(st.data())
@settings(max_examples=200, deadline=None)
def test_a_run_takes_every_combination_that_an_export_takes(data):
    """Within its bounds and at them, each parameter on its own."""
    role, method = data.draw(st.sampled_from(sorted(methods())))
    values = {}
    for tunable in tunables(role, method):
        low, high = max(tunable.low, -_LARGE), min(tunable.high, _LARGE)
        inside = st.sampled_from([low, high]) | st.floats(low, high)
        values[tunable.name.removeprefix(f"{role}.")] = data.draw(inside, label=tunable.name)
    methods()[role, method].configurations[role].changed(values)


def _made_beforehand(configuration: Configuration) -> list[float]:
    """Constants and first state of a law, without the parameters that it reads itself."""
    method, common = configuration.method, configuration.common
    given = given_to(method, configuration.given, common.vehicle, common.control_period)
    made = {name: tree for name, tree in given.trees.items() if name != "p"}
    constants = constants_row(made, given.values["c"], common.control_period)
    return [*constants.tolist(), *numbers(given.values["s"])]


@given(st.data())
@settings(max_examples=200, deadline=None)
def test_what_an_export_lets_change_is_part_of_nothing_that_is_made_beforehand(data):
    """Setting it changes something. The constants in the export are those of its first value."""
    role, method = data.draw(
        st.sampled_from([each for each in sorted(methods()) if tunables(*each)])
    )
    configuration = methods()[role, method].configurations[role]
    tunable = data.draw(st.sampled_from(tunables(role, method)))
    low, high = max(tunable.low, -_LARGE), min(tunable.high, _LARGE)
    value = data.draw(st.floats(low, high))
    changed = configuration.changed({tunable.name.removeprefix(f"{role}."): value})
    assert _made_beforehand(changed) == _made_beforehand(configuration), tunable.name


def test_what_does_nothing_without_an_option_is_fixed_in_an_export():
    """The speed control of the drives is used in speed mode alone."""
    gain = "plant.speed_control.gain"
    without = Content(only_run("double_lane_change", "", overrides()), only=["plant"])
    assert gain not in [each.name for part in without.parts for each in part.tunables]
    with_it = overrides(method={"asr": "speed_by_slip"})
    content = Content(only_run("double_lane_change", "", with_it), only=["plant"])
    assert gain in [each.name for part in content.parts for each in part.tunables]


def test_a_group_that_is_handed_on_whole_is_fixed_in_an_export():
    """The tested machine's DC link is among the constants of the bench, the load's is not."""
    names = [tunable.name for tunable in tunables("test_bench", "circuits_on_can")]
    assert "test_bench.load.dc_link.supply_voltage" in names
    assert not [name for name in names if name.startswith("test_bench.dc_link.")]


@pytest.mark.parametrize(
    ("role", "method", "free", "tied"),
    [
        (
            "electronic_differential",
            "direct_yaw_moment",
            "wanted.gradient",
            ("first_sideslip", "last_sideslip"),
        ),
        ("asr", "least_squares", "use", ("backstop", "least_slip", "first_slip")),
        ("asr", "slip_window", "rise", ("low", "high")),
    ],
)
def test_what_a_rule_ties_to_others_is_fixed_in_an_export(role, method, free, tied):
    names = [tunable.name for tunable in tunables(role, method)]
    assert f"{role}.{free}" in names
    assert not [name for name in names if name.rpartition(".")[2] in tied]
