"""The declared graph.

Order within a step, what is refused when it is built, and what a method has to hear.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_core.lockstep.finding import find_method
from ev_core.lockstep.graph import GraphError, sequence, step_order, writers
from ev_core.methods import register as registered
from ev_core.methods.method_record import Method
from ev_core.methods.register import all_methods, method
from ev_msgs_py.contract.roles import ROLES, Role, RoleKind
from ev_msgs_py.contract.signals import (
    BodyPose,
    BodyVelocity,
    DriverCommand,
    Instant,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.refusal import ParameterError

SIGNALS = tuple(type(f"Signal{i}", (), {}) for i in range(6))


def role(name: str, reads=(), writes=(), kind=RoleKind.ANSWERS) -> Role:
    return Role(name, kind, tuple(reads), tuple(writes), "")


def graph(*roles: Role) -> dict[str, Role]:
    return {role.name: role for role in roles}


def test_the_chain_of_the_design():
    """design.md: driver -> electronic_differential -> asr -> plant.

    Plant and column speak first.
    """
    answering = ("driver", "electronic_differential", "asr", "inverter_gateway")
    assert step_order(ROLES) == answering
    assert sequence(ROLES) == (
        "plant",
        "steering_column",
        "rear_steering",
        "test_bench",
        *answering,
    )


@given(st.permutations(range(6)), st.data())
def test_a_role_that_is_read_answers_first(order, data):
    """Any graph without a cycle, declared in any order."""
    roles = []
    for place, name in enumerate(order):
        earlier = order[:place]
        reads = data.draw(st.sets(st.sampled_from(earlier))) if earlier else set()
        roles.append(role(str(name), [SIGNALS[i] for i in sorted(reads)], [SIGNALS[name]]))
    declared = graph(*data.draw(st.permutations(roles)))
    found = step_order(declared)
    assert sorted(found) == sorted(declared)
    for name in found:
        for signal in declared[name].reads:
            assert found.index(str(SIGNALS.index(signal))) < found.index(name)
    assert step_order(declared) == found


def test_a_cycle_within_one_step_is_refused_and_named():
    a, b, c = SIGNALS[:3]
    with pytest.raises(GraphError) as error:
        step_order(graph(role("one", [c], [a]), role("two", [a], [b]), role("three", [b], [c])))
    assert all(name in str(error.value) for name in ("one", "two", "three"))
    with pytest.raises(GraphError, match="one -> one"):
        step_order(graph(role("one", [a], [a])))


def test_a_loop_through_a_role_that_integrates_is_none():
    """Its output follows from the step before."""
    a, b = SIGNALS[:2]
    declared = graph(role("law", [a], [b]), role("plant", [b], [a], RoleKind.INTEGRATES))
    assert step_order(declared) == ("law",)
    assert sequence(declared) == ("plant", "law")


def test_two_writers_of_one_signal_are_refused():
    a = SIGNALS[0]
    with pytest.raises(GraphError, match="Signal0 is written by both one and two"):
        writers(graph(role("one", [], [a]), role("two", [], [a])))


@pytest.mark.parametrize("kind", RoleKind)
def test_a_signal_without_a_writer_is_refused(kind):
    with pytest.raises(GraphError, match="one reads Signal0, which no role writes"):
        step_order(graph(role("one", [SIGNALS[0]], [], kind)))


# The register of methods


@dataclass(frozen=True, slots=True)
class NoParameters:
    """Nothing to choose."""


@pytest.fixture
def register(monkeypatch):
    """A register that is forgotten after the test."""
    copy = {role: dict(known) for role, known in all_methods().items()}
    monkeypatch.setattr(registered, "_REGISTER", copy)
    return copy


def test_a_method_reads_what_its_step_names(register):
    @method("driver", "sleeper")
    class Sleeper:
        """Sleeps at the wheel.

        And more.
        """

        parameters = NoParameters

        def step(self, now: Instant, body: BodyVelocity) -> DriverCommand:
            """Nothing."""

    found = find_method("driver", "sleeper")
    assert found.reads == (Instant, BodyVelocity)
    assert found.inputs == (BodyVelocity,)
    assert found.writes == (DriverCommand,)
    assert found.about == "Sleeps at the wheel."
    assert "sleeper" in register["driver"]


@pytest.mark.parametrize("signal", [WheelTorqueRequest, DriverCommand])
def test_a_method_that_reads_what_its_role_may_not_is_refused(register, signal):
    class Seer:
        parameters = NoParameters

        def step(self, ahead):
            """Reads what is not known yet."""

    Seer.step.__annotations__["ahead"] = signal
    with pytest.raises(TypeError) as error:
        method("driver", "seer")(Seer)
    assert (
        str(error.value)
        == f"driver method seer: a driver does not read {signal.__name__} (see roles.py)"
    )
    assert "seer" not in register["driver"]


def test_advance_counts_for_a_role_that_integrates(register):
    class Column:
        parameters = NoParameters
        writes = (SteeringColumnState,)

        def step(self, command: WheelTorqueCommand):
            """A method that no runner calls for a column."""

        def outputs(self) -> tuple[SteeringColumnState]:
            """Nothing."""

        def advance(self, driver: DriverCommand) -> None:
            """Its inputs."""

    method("steering_column", "test")(Column)
    found = find_method("steering_column", "test")
    assert found.reads == (DriverCommand,)
    assert found.writes == (SteeringColumnState,)


@pytest.mark.parametrize("name", ["powr_steering", "", None, 5, ["power_steering"]])
def test_an_unknown_method_is_asked_for_or_the_known_ones_are_listed(name):
    with pytest.raises(ParameterError) as error:
        find_method("electronic_differential", name)
    text = str(error.value)
    assert text.startswith(f"unknown electronic_differential method {name!r}; ")
    assert (
        "; known: " in text and "equal_torque" in text
    ) or "; did you mean power_steering" in text


def test_every_role_has_the_method_that_it_plays_by_default():
    for name, known in all_methods().items():
        assert ROLES[name].default_method in known
        assert all(found.about for found in known.values())


# What a node has to hear


@pytest.mark.parametrize(
    ("role", "reads", "inputs"),
    [
        # a column speaks first, so it must hear the master even if it uses the driver's hands only
        ("steering_column", (DriverCommand,), (DriverCommand, WheelStates)),
        ("steering_column", (DriverCommand, WheelStates), (DriverCommand, WheelStates)),
        # the master hears the column, to know that it has stepped
        ("plant", (WheelTorqueCommand,), (WheelTorqueCommand, SteeringColumnState)),
        (
            "plant",
            (SteeringColumnState, WheelTorqueCommand),
            (SteeringColumnState, WheelTorqueCommand),
        ),
        # the clock alone makes no node step
        ("driver", (Instant,), (BodyVelocity,)),
        ("asr", (), (WheelTorqueRequest,)),
        # the column repeats its last two answers, so its stamp zero announces no new run
        ("driver", (SteeringColumnState,), (SteeringColumnState, BodyVelocity)),
        ("electronic_differential", (SteeringColumnState,), (SteeringColumnState, DriverCommand)),
        # a role that answers before announces it as well as the master does
        ("electronic_differential", (DriverCommand,), (DriverCommand,)),
        ("asr", (WheelTorqueRequest,), (WheelTorqueRequest,)),
        ("electronic_differential", (BodyPose,), (BodyPose,)),
    ],
)
def test_a_node_hears_what_it_reads_and_what_it_needs_to_keep_step(role, reads, inputs):
    assert Method(role, "test", object, reads, NoParameters).inputs == inputs


@pytest.mark.parametrize("name", ROLES)
def test_inputs_of_every_installed_method_may_be_read_by_its_role(name):
    for found in all_methods()[name].values():
        assert set(found.inputs) <= set(ROLES[name].reads)
        assert set(found.writes) <= set(ROLES[name].may_write)
        assert found.inputs
