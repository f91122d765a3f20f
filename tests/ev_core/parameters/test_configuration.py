"""One resolution of names and values for the node and for the offline runner."""

from __future__ import annotations

import dataclasses
from dataclasses import make_dataclass

import pytest
from helpers.toy_methods import toy, toy_graph

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.lockstep.graph import check_graph
from ev_core.methods.common_parameters import CommonParameters, refuse_taken
from ev_core.methods.register import all_methods, method, methods_of
from ev_core.parameters.declaration import flatten, parameter
from ev_core.parameters.values import entries_by_name
from ev_msgs_py.contract.roles import MASTER, REQUIRED, ROLES
from ev_msgs_py.contract.signals import BodyVelocity, SteeringColumnState, TireForces
from ev_msgs_py.refusal import ParameterError
from ev_nodes.master.real_time import MasterParameters

DIFFERENTIAL = "electronic_differential"


def refused(role: str, values: dict, extra: type | None = None) -> str:
    with pytest.raises(ParameterError) as error:
        configure(role, values, extra)
    text = str(error.value)
    assert "\n" not in text
    return text


def graph(**values: dict) -> dict:
    return {role: configure(role, values.get(role, {})) for role in REQUIRED}


@pytest.mark.parametrize("role", REQUIRED)
def test_without_values_the_default_method_plays_with_its_defaults(role):
    found = configure(role, {})
    assert found.method.name == ROLES[role].default_method
    assert found.parameters == found.method.parameters()
    assert (found.unused, found.extra, found.period) == ((), None, 10_000_000)
    assert found.create() is not found.create()


def test_values_reach_the_method_the_common_part_and_the_node():
    values = {
        "method": "power_steering",
        "gamma": 3,
        "control_period": 0.001,
        "vehicle.mass": 900,
        "duration": 7,
    }
    found = configure(DIFFERENTIAL, values, MasterParameters)
    assert found.parameters.gamma == 3.0
    assert found.common.vehicle.mass == 900.0
    assert found.extra.duration == 7.0
    assert found.period == 1_000_000
    shown = found.values()
    assert {name: shown[name] for name in values} == values


def test_a_bare_off_is_the_method_of_this_name():
    """YAML 1.1 and ROS read `method: off` as false; there is one thing that can be meant."""
    assert configure("asr", {"method": False}).method.name == "off"
    assert refused("driver", {"method": False}).startswith("unknown driver method 'off'; known: ")
    assert refused("asr", {"method": True}).startswith("unknown asr method True; known: ")


def test_values_of_a_sibling_method_are_checked_and_named_as_unused():
    """One scenario file serves several methods; a mistake in it shows all the same."""
    found = configure(DIFFERENTIAL, {"method": "equal_torque", "gamma": 3.0})
    assert found.unused == ("gamma",)
    assert refused(DIFFERENTIAL, {"method": "equal_torque", "gamma": -1.0}).startswith(
        "parameter gamma: -1.0"
    )
    assert refused(DIFFERENTIAL, {"method": "equal_torque", "gamma": "much"}).startswith(
        "parameter gamma: 'much'"
    )


def test_an_unknown_name_asks_for_the_similar_one_and_lists_not_all_of_very_many():
    text = refused(DIFFERENTIAL, {"method": "power_steering", "gama": 3.0}, MasterParameters)
    assert text == f"unknown parameter of {DIFFERENTIAL} 'gama'; did you mean gamma?"
    text = refused(DIFFERENTIAL, {"method": "power_steering", "?": 3.0}, MasterParameters)
    known = text.partition("known: ")[2].split(", ")
    assert len(known) == len({*known}) == 12
    assert text.endswith(" more")


@pytest.mark.parametrize(
    "values",
    [
        {"control_period": 0.0},
        {"control_period": "fast"},
        {"mode": "dreaming"},
        {"seed": -1},
        {"seed": 2**31},
        {"vehicle.mass": 0},
        {"vehicle.driven_wheels": ["front_middle"]},
        {"real_time_factor": -1},
    ],
)
def test_bad_common_and_further_values_are_refused_by_name(values):
    assert refused("plant", values, MasterParameters).startswith(
        f"parameter {next(iter(values))}: "
    )


def test_the_entries_are_what_ros_declares():
    """`ros2 param list`.

    The method and the common part are fixed when the node starts, the rest can be set.
    """
    entries = {
        entry.name: entry
        for entry in configure(DIFFERENTIAL, {"gamma": 2.0}, MasterParameters).entries()
    }
    assert entries["method"].spec.choices == tuple(methods_of(DIFFERENTIAL))
    assert {"drive_by_wire", "equal_torque", "power_steering", "steer_by_wire"} <= {
        *methods_of(DIFFERENTIAL)
    }
    fixed = {name for name, entry in entries.items() if entry.spec.read_only}
    assert {"method", "control_period", "mode", "seed", "vehicle.mass", "await_recorder"} <= fixed
    assert not {"gamma", "real_time_factor"} & fixed


def test_a_change_keeps_everything_else_and_leaves_the_old_one_alone():
    values = {"method": "power_steering", "gamma": 3.0, "vehicle.mass": 900.0}
    before = configure(DIFFERENTIAL, values, MasterParameters)
    shown = before.values()
    after = before.changed({"gamma": 4.0})
    assert after.values() == {**shown, "gamma": 4.0}
    assert before.values() == shown
    assert after.changed({}).values() == after.values()


@pytest.mark.parametrize(
    "values", [{"gamma": -1.0}, {"gamma": 4.0, "unknown": 1}, {"gamma": 4.0, "k_ck": "soft"}]
)
def test_a_refused_change_changes_nothing(values):
    before = configure(DIFFERENTIAL, {"method": "power_steering"})
    shown = before.values()
    with pytest.raises(ParameterError):
        before.changed(values)
    assert before.values() == shown


def test_a_profile_file_is_read_once(tmp_path):
    """The node shows its points afterwards; the file may be gone when a parameter is set later."""
    file = tmp_path / "cycle.csv"
    file.write_text("t_s,v_mps\n0,1\n2,3\n")
    found = configure("driver", {"speed_profile.file": str(file)})
    assert found.values()["speed_profile.time"] == (0.0, 2.0)
    file.unlink()
    later = found.changed({"speed_control.proportional_gain": 1.0})
    assert later.parameters.speed_profile == found.parameters.speed_profile
    assert refused("driver", {"speed_profile.file": str(file)}).startswith("speed_profile.file: ")


# The whole graph


def refused_graph(configurations: dict) -> str:
    with pytest.raises(ParameterError) as error:
        check_graph(configurations)
    text = str(error.value)
    assert "\n" not in text
    return text


def test_a_graph_of_defaults_fits_together():
    check_graph(graph())
    check_graph(toy_graph())


@pytest.mark.parametrize(
    ("name", "value", "other"),
    [
        ("control_period", 0.02, 0.01),
        ("vehicle.mass", 900.0, 1400.0),
        ("mode", "realtime", "lockstep"),
    ],
)
def test_nodes_that_differ_in_what_they_share_are_refused(name, value, other):
    """The line lists the value of each node, for the names that differ only."""
    text = refused_graph(graph(asr={name: value}))
    assert text == (
        f"{name} differs between nodes: plant {other}, steering_column {other}, driver {other}, "
        f"electronic_differential {other}, asr {value}; expected one for all"
    )


def test_seeds_may_differ():
    check_graph(graph(driver={"seed": 5}))


def test_a_signal_that_no_chosen_method_writes_is_refused():
    """A plant model writes what it can know.

    A reader of more would wait for ever. An input that only has to arrive counts, too.
    """
    configurations = toy_graph(driver=(SteeringColumnState,), rear_steering=(TireForces,))
    plant = configurations["plant"]

    class Blind(plant.method.factory):
        writes = tuple(signal for signal in plant.method.writes if signal is not BodyVelocity)

    method = dataclasses.replace(plant.method, factory=Blind)
    configurations["plant"] = dataclasses.replace(plant, method=method)
    text = refused_graph(
        {**configurations, "asr": toy("asr", ()), DIFFERENTIAL: toy(DIFFERENTIAL, ())}
    )
    assert text.startswith(
        "steering_column method toy reads BodyVelocity, which none of the chosen methods writes ("
    )


def test_a_law_that_requires_a_column_is_refused_with_another():
    law = {"method": "steer_by_wire"}
    check_graph(graph(electronic_differential=law, steering_column={"method": "by_wire"}))
    text = refused_graph(graph(electronic_differential=law, steering_column={"method": "powered"}))
    assert text == (
        "electronic_differential method steer_by_wire requires steering_column method by_wire, but powered is chosen"
    )


def test_a_driver_that_requires_an_imposed_speed_is_refused_with_a_free_one():
    """A plant that cannot impose one is refused as well."""
    foot = {"method": "imposed_speed"}
    check_graph(graph(driver=foot, plant={"method": "planar", "speed": "imposed"}))
    lacks = "plant method kinematic does not have it"
    for plant, found in (
        ({"method": "planar"}, "free is chosen"),
        ({"method": "kinematic"}, lacks),
    ):
        text = refused_graph(graph(driver=foot, plant=plant))
        assert text == f"driver method imposed_speed requires plant.speed imposed, but {found}"


@pytest.mark.parametrize(
    "name", ["seed", "mode", "method", "faults", "vehicle", "sensors", "control_period"]
)
def test_a_law_with_a_parameter_of_every_node_is_refused_when_it_is_registered(name):
    """The law would never get its `seed`, and `mode` and `faults` would be two in one."""
    own = make_dataclass("Own", [(name, float, parameter(1.0, unit="1", about="own"))], frozen=True)
    message = f"^asr method own: parameter {name} is refused: every node has one of this name, take another$"
    with pytest.raises(TypeError, match=message):
        method("asr", "own", parameters=own)(lambda p: None)
    assert "own" not in methods_of("asr")


def test_the_master_of_time_has_names_besides():
    own = make_dataclass(
        "Own", [("duration", float, parameter(1.0, unit="s", about="own"))], frozen=True
    )
    with pytest.raises(
        ParameterError, match=r"^plant method own: parameter duration is refused: every node has"
    ):
        refuse_taken("plant method own", own, entries_by_name(MasterParameters))


@pytest.mark.parametrize(
    ("role", "name"), [(role, name) for role, of in all_methods().items() for name in of]
)
def test_no_parameter_of_a_method_hides_one_that_every_node_has(role, name):
    """Both would be declared under one name, and the node would take the one for the other."""
    of_node = {
        *flatten(CommonParameters()),
        *(flatten(MasterParameters()) if role == MASTER else ()),
        "method",
    }
    assert not of_node & set(flatten(find_method(role, name).parameters()))
