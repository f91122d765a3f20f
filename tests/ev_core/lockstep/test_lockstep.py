"""Lockstep without ROS.

Steppers on a faulty network give, bit for bit, what the offline runner gives.
"""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
import pytest
from helpers.fake_network import FakeNetwork, Faults, WatchedStepper
from helpers.toy_methods import OFFERED, begun_at, toy, toy_graph
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numba import njit

from ev_core.compiling.machine_code import register_functions
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.graph import sequence
from ev_core.lockstep.holding import HELD, HoldingInbox
from ev_core.lockstep.inbox import (
    LAST,
    NEVER,
    NEW,
    ROWS,
    Arrival,
    Inbox,
    Inputs,
    Steps,
    judged,
    keep,
    missing,
    note_answer,
)
from ev_core.lockstep.stepper import arrival_place, upstream_signals
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES, TIME
from ev_msgs_py.contract.optional_signals import BenchShafts, RearSteeringState, SetPointFrames
from ev_msgs_py.contract.roles import EXTRA, MASTER, REQUIRED, ROLES, RoleKind
from ev_msgs_py.contract.signals import (
    BodyPose,
    BodyVelocity,
    DriverCommand,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.stamps import RUN, RUNS
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import load_scenario

PERIOD = 10_000_000
OTHERS = tuple(role for role in REQUIRED if role != MASTER)
# What a method of the role cannot do without: the chain from driver to plant, by bus and bench if
# they are there.
ESSENTIAL = {
    "plant": (WheelTorqueCommand, RearSteeringState, BenchShafts),
    "steering_column": (DriverCommand,),
    "electronic_differential": (DriverCommand,),
    "asr": (WheelTorqueRequest,),
    "inverter_gateway": (WheelTorqueCommand,),
    "test_bench": (SetPointFrames,),
}
faults = st.builds(Faults, st.floats(0, 0.4), st.floats(0, 0.3), st.sampled_from((0.0, 0.002)))

# Turns up to a reset, and before it another start state of one role.
changes = st.tuples(st.integers(0, 80), st.sampled_from(tuple(ROLES)), st.floats(0.01, 0.99))


# One in 400 of the resets below: a message of instant zero that comes late restarts the column with
# its new parameters.
LATE_ZERO = toy_graph(
    roles=REQUIRED,
    plant=(WheelTorqueCommand, SteeringColumnState),
    steering_column=(DriverCommand, WheelStates, TireForces, BodyVelocity),
    driver=(BodyVelocity,),
    electronic_differential=(DriverCommand,),
    asr=(WheelTorqueRequest, SteeringColumnState, BodyPose),
)
LATE_FAULTS = Faults(0.0077129208292797905, 0.174934765026895, 0.002)


@st.composite
def graphs(draw: st.DrawFn) -> dict[str, Configuration]:
    """Toys of which each reads what it needs and some of what it may read besides.

    With or without optional roles.
    """
    roles, reads = draw(st.sampled_from((tuple(ROLES), REQUIRED))), {}
    for name in roles:
        readable = [
            s
            for s in ROLES[name].reads
            if s not in OFFERED and (s not in EXTRA or roles != REQUIRED)
        ]
        optional = [signal for signal in readable if signal not in ESSENTIAL.get(name, ())]
        chosen = draw(st.sets(st.sampled_from(optional))) if optional else set()
        reads[name] = tuple(s for s in readable if s in chosen or s in ESSENTIAL.get(name, ()))
    return toy_graph(roles=roles, **reads)


def lossless(configurations: dict[str, Configuration], steps: int) -> FakeNetwork:
    network = FakeNetwork(configurations, steps)
    network.begin()
    network.run()
    return network


def play(network: FakeNetwork, turns: int) -> None:
    """Some turns, unless the run ends before."""
    while turns > 0 and not network.at_end:
        network.turn()
        turns -= 1


def bits(recording: Recording) -> dict[str, list[str]]:
    return {
        name: [float.hex(number) for number in column.tolist()]
        for name, column in recording.channels.items()
    }


def assert_each_stepped_once(network: FakeNetwork, but: str = "") -> None:
    """The master steps from an instant to the next, so one time less."""
    for role, stepper in network.steppers.items():
        if role != but:
            instants = network.instants()
            assert stepper.stepped == (instants[:-1] if role == MASTER else instants), role


# A whole run


@settings(max_examples=20)
@given(graphs())
def test_without_faults_the_network_gives_what_the_offline_runner_gives(configurations):
    """design.md: a node is a pure function of stamped inputs, in whatever order they come."""
    network = lossless(configurations, 12)
    assert network.signals() == bits(run_offline(configurations, 0.12))
    assert network.silences == 0


@settings(max_examples=40)
@given(graphs(), st.integers(0, 2**32), faults)
def test_lost_repeated_and_delayed_messages_change_no_bit(configurations, seed, faults):
    """A lost message costs time, not truth.

    The master's repetition brings back whatever is missing.
    """
    network = FakeNetwork(configurations, 8, seed, faults)
    network.begin()
    network.run()
    assert network.signals() == lossless(configurations, 8).signals()
    assert_each_stepped_once(network)
    assert not {Arrival.GAP, Arrival.RESTART} & set(network.arrivals)


@pytest.mark.parametrize("seed", range(3))
def test_a_scenario_survives_faults_bit_for_bit(seed):
    """The real methods on the scenario of the paper.

    One second suffices, for nothing differs between the steps.
    """
    configurations = load_scenario("shchur2019").runs[0].configurations
    network = FakeNetwork(configurations, 100, seed, Faults(0.1, 0.1, 0.001))
    network.begin()
    network.run()
    assert network.signals() == bits(run_offline(configurations, 1.0))


@pytest.mark.slow
@settings(max_examples=40)
@given(graphs(), st.integers(0, 2**32), faults)
def test_topics_that_connect_late_change_no_bit(configurations, seed, faults):
    """Discovery connects each reader to each topic at its own time.

    What was sent before is lost.
    """
    network = FakeNetwork(configurations, 5, seed, faults)
    links = [(role, kind) for role, stepper in network.steppers.items() for kind in stepper.reads]
    chance = random.Random(seed)
    network.deaf = {link for link in links if chance.random() < 0.7}
    network.begin()
    while network.deaf:
        network.drain()
        network.deaf.discard(chance.choice(links))
        network.retry()
    network.run()
    assert network.signals() == lossless(configurations, 5).signals()
    assert_each_stepped_once(network)


@pytest.mark.slow
@settings(max_examples=40)
@given(graphs(), st.integers(0, 2**32), faults, st.lists(changes, max_size=5))
@example(LATE_ZERO, 2120580269, LATE_FAULTS, [(13, "steering_column", 0.95)])
def test_resets_and_changes_at_any_time_end_in_a_fresh_run_with_the_same_values(
    configurations, seed, faults, changes
):
    """The first instants count too, and messages of runs before that are still under way."""
    configurations = dict(configurations)
    network = FakeNetwork(configurations, 6, seed, faults)
    network.begin()
    for turns, role, start in changes:
        play(network, turns)
        if role in configurations:
            configurations[role] = begun_at(configurations[role], start)
            network.steppers[role].change(configurations[role])
        network.begin()
    network.run()
    assert network.signals() == lossless(configurations, 6).signals()


@pytest.mark.slow
@settings(max_examples=40)
@given(graphs(), st.sampled_from(OTHERS), st.integers(0, 2**32), faults, st.integers(0, 400))
def test_a_restarted_node_lets_the_run_go_on(configurations, role, seed, faults, turns):
    """It joins at the present instant, without a gap from there on; each other node steps once."""
    network = FakeNetwork(configurations, 10, seed, faults)
    network.begin()
    play(network, turns)
    network.forgives = True  # its state is lost: it may say something else about the same instant
    network.restart(role)
    network.run()
    assert_each_stepped_once(network, but=role)
    stepped = network.steppers[role].stepped
    assert stepped == [stamp for stamp in network.instants() if stepped and stamp >= stepped[0]]


@settings(max_examples=30)
@given(graphs(), st.integers(0, 2**32), st.integers(0, 300))
def test_a_retry_leads_to_a_bounded_number_of_messages(configurations, seed, turns):
    """Repetitions run down the graph only, so a retry ends.

    Counted along the declared order of the roles.

    A node answers each repeated message of those before it with its last answer, one that
    integrates with the last two; where a step becomes possible it answers once more.
    """
    network = FakeNetwork(configurations, 6, seed, Faults(0.3))
    network.begin()
    play(network, turns)
    network.frozen = True
    network.drain()
    network.faults = Faults()
    for _ in range(3):
        network.retry()
        assert network.drain() <= most_messages_of_a_retry(network)


def most_messages_of_a_retry(network: FakeNetwork) -> int:
    count = dict.fromkeys(ROLES[MASTER].writes, 1)
    for role in sequence(ROLES)[1:]:
        if role not in network.steppers:
            continue
        stepper = network.steppers[role]
        heard = sum(count.get(kind, 0) for kind in stepper.reads)
        for kind in ROLES[role].writes:
            count[kind] = 1 + (2 if stepper.integrates else 1) * heard
    return sum(count.values())


# The inbox


def inbox(reads=(DriverCommand, WheelStates), may_skip=False, **more) -> Inbox:
    return Inbox(Inputs(reads, PERIOD, frozenset(reads), **more), may_skip)


def fill(box: Inbox, stamp: int) -> None:
    for place, kind in enumerate(box.reads):
        say(box, kind, stamp, stamp + place)


def say(box: Inbox, kind: type, stamp: int, number: float = 0.0) -> Arrival:
    """Offer a message with this first number, as a node does."""
    return box.offer(kind, stamp, [number, *[0.0] * (shape_of(kind).size - 1)])


def first_numbers(box: Inbox, stamp: int) -> list[float]:
    """Take a step and return the first number of each input."""
    here = box.take(stamp)
    return [here.numbers[PLACES[kind].start] for kind in box.reads]


def test_a_step_is_complete_when_every_input_is_there():
    box = inbox()
    assert say(box, WheelStates, 0, 1.0) is Arrival.NEW
    assert box.complete() is None
    assert say(box, DriverCommand, 0, 2.0) is Arrival.NEW
    assert box.complete() == 0
    assert first_numbers(box, 0) == [2.0, 1.0]
    assert box.complete() is None


def test_the_first_of_two_messages_of_one_stamp_counts():
    """A node that answered the first one has answered; the second can only be a repetition."""
    box = inbox((DriverCommand,))
    assert say(box, DriverCommand, 0, 1.0) is Arrival.NEW
    assert say(box, DriverCommand, 0, 2.0) is Arrival.REPEATED
    assert first_numbers(box, 0) == [1.0]
    assert say(box, DriverCommand, 0, 3.0) is Arrival.REPEATED


@pytest.mark.parametrize(
    ("stamp", "arrival"),
    [
        (5 * PERIOD, Arrival.REPEATED),
        (4 * PERIOD, Arrival.OLD),
        (PERIOD, Arrival.OLD),
        (0, Arrival.RESTART),
        (6 * PERIOD, Arrival.NEW),
        (7 * PERIOD, Arrival.GAP),
        (8 * PERIOD, Arrival.GAP),
        (6 * PERIOD + 1, Arrival.GAP),
        (6 * PERIOD - 1, Arrival.GAP),
        (5 * PERIOD - 1, Arrival.GAP),
        (RUN, Arrival.RESTART),
        (7 * RUN, Arrival.RESTART),
        (RUN + 1, Arrival.GAP),
        (RUNS, Arrival.GAP),
        (6 * PERIOD + RUN, Arrival.OLD),
        (10**18, Arrival.GAP),
        (-PERIOD, Arrival.OLD),
    ],
)
def test_what_a_stamp_means_after_the_step_five(stamp, arrival):
    """Table of docs/lockstep.md.

    The first stamp of a run begins a new one, and no herald leaves out a step.
    """
    box = inbox()
    fill(box, 5 * PERIOD)
    box.take(5 * PERIOD)
    assert say(box, DriverCommand, stamp) is arrival


def test_only_a_herald_begins_a_new_run():
    """Integrating nodes repeat their last two answers: stamp zero may be a late repetition."""
    box = Inbox(Inputs((DriverCommand, SteeringColumnState), PERIOD, frozenset({DriverCommand})))
    fill(box, PERIOD)
    box.take(PERIOD)
    assert say(box, SteeringColumnState, 0) is Arrival.OLD
    assert say(box, DriverCommand, 0) is Arrival.RESTART
    assert box.missing() == (SteeringColumnState,)


def test_refused_messages_are_not_kept():
    box = inbox()
    fill(box, PERIOD)
    box.take(PERIOD)
    for stamp in (1, PERIOD, PERIOD + 1, 4 * PERIOD):
        assert say(box, WheelStates, stamp) is not Arrival.NEW
    fill(box, 2 * PERIOD)
    assert first_numbers(box, 2 * PERIOD) == [2 * PERIOD, 2 * PERIOD + 1]
    fill(box, 3 * PERIOD)
    box.take(3 * PERIOD)
    assert box.missing() == box.reads  # nothing of the step 4


def test_no_step_is_left_out_in_lockstep():
    """A complete step waits for the one before it: leaving that out would be another run.

    A node that speaks before this one in the step has left one out if its period is another one, or
    ours.
    """
    box = Inbox(Inputs((DriverCommand, SteeringColumnState), PERIOD, frozenset({DriverCommand})))
    fill(box, 0)
    box.take(0)
    assert say(box, DriverCommand, 2 * PERIOD) is Arrival.GAP
    assert say(box, SteeringColumnState, 2 * PERIOD, 2 * PERIOD + 1) is Arrival.NEW
    assert box.complete() is None
    fill(box, PERIOD)
    assert box.complete() == PERIOD
    box.take(PERIOD)
    assert say(box, DriverCommand, 2 * PERIOD) is Arrival.NEW
    assert box.complete() == 2 * PERIOD


@pytest.mark.parametrize("times", [0.5, 2.0, 1.0 / 3.0])
@pytest.mark.parametrize("role", REQUIRED)
def test_a_node_with_another_period_is_found_wherever_it_stands(role, times):
    """A node with another period leaves a gap that its readers see, within one step."""
    configurations = dict(load_scenario("double_lane_change").runs[0].configurations)
    configurations[role] = configurations[role].changed({"control_period": 0.01 * times})
    network = FakeNetwork(configurations, 10)
    network.begin()
    play(network, 100)
    assert network.now <= PERIOD
    assert Arrival.GAP in network.arrivals


def test_a_joining_node_begins_with_the_newest_complete_step():
    box = inbox()
    for stamp in (30 * PERIOD, 31 * PERIOD):
        fill(box, stamp)
    assert box.complete() == 31 * PERIOD


def test_incomplete_steps_do_not_pile_up():
    """A node that hears one topic only, for hours, keeps a handful of messages."""
    box = inbox(may_skip=True)
    for step in range(1000):
        assert say(box, WheelStates, step * PERIOD) is Arrival.NEW
    assert len(box.waiting) < 10
    assert say(box, DriverCommand, 999 * PERIOD) is Arrival.NEW
    assert box.complete() == 999 * PERIOD


@given(
    st.lists(
        st.tuples(
            st.sampled_from((DriverCommand, WheelStates, SteeringColumnState)), st.integers(0, 3)
        )
    ),
    st.sampled_from((frozenset(), frozenset({SteeringColumnState}))),
)
def test_what_is_missing_is_what_has_not_come(messages, followed):
    """Asked after every message, as a node does, or only at the end: the same."""
    asked, unasked = (
        inbox((DriverCommand, WheelStates, SteeringColumnState), followed=followed)
        for _ in range(2)
    )
    for box in (asked, unasked):
        box.expect(0)
    kept = []
    for kind, step in messages:
        arrivals = [say(box, kind, step * PERIOD) for box in (asked, unasked)]
        assert arrivals[0] is arrivals[1]
        if arrivals[0] is Arrival.NEW:  # a herald that leaves out a step is a gap
            kept.append((kind, step))
        asked.missing()
    assert asked.missing() == unasked.missing()
    come = {kind for kind, step in kept if step == 0}
    gone_on = {kind for kind, step in kept if step == 1} | set(asked.reads) - followed
    assert set(asked.missing()) == set(asked.reads) - (come & gone_on)


def test_a_followed_input_must_have_gone_on():
    """The master waits for integrating nodes: its inputs are not repeated later."""
    box = inbox(followed=frozenset({WheelStates}))
    box.expect(0)
    fill(box, 0)
    assert box.complete() is None
    assert box.missing() == (WheelStates,)
    say(box, WheelStates, PERIOD)
    assert box.complete() == 0


def test_realtime_takes_the_newest_complete_step_and_forgets_the_older():
    box = inbox(may_skip=True)
    for stamp in (0, PERIOD, 7 * PERIOD):
        fill(box, stamp)
    assert box.complete() == 7 * PERIOD
    box.take(7 * PERIOD)
    assert box.complete() is None
    assert say(box, WheelStates, 50 * PERIOD) is Arrival.NEW
    assert say(box, WheelStates, 49 * PERIOD + 1) is Arrival.GAP


@pytest.fixture(scope="module")
def compiled_inbox() -> Callable[[int, Steps, np.ndarray, np.ndarray], list[int]]:
    """Run the compiled protocol: arrival of each message, and the inputs missing then."""

    @njit(error_model="numpy")
    def taken(steps, stamps, inputs):
        found = [(0, 0)]
        for stamp, i in zip(stamps, inputs):  # noqa: B905, compiled
            arrival = judged(steps, stamp, i)
            if arrival == NEW:
                keep(steps, stamp, i)
            if missing(steps) == 0:
                steps.done[LAST] += steps.period
                note_answer(steps, steps.done[LAST] + steps.lead)
            found.append((arrival, missing(steps)))
        return found

    register_functions()
    return taken


STAMPS = st.integers(-2, 12).map(lambda step: step * PERIOD) | st.sampled_from(
    [7, RUN, RUNS, 3 * PERIOD + RUN]
)


@given(
    st.lists(st.tuples(STAMPS, st.integers(0, 2)), min_size=1),
    st.sampled_from([(7, 0, 0, 0), (3, 0, PERIOD, 0), (1, 4, PERIOD, 0), (7, 0, 0, 1)]),
    st.booleans(),
)
@settings(deadline=None)
def test_the_protocol_means_the_same_compiled(compiled_inbox, messages, constants, under_way):
    """It is one text.

    `Inbox` and a node in Python interpret it, the loop of a node is compiled from it.
    """
    heralds, followed, lead, may_skip = constants
    ways = []
    for judge_all in (compiled_inbox, compiled_inbox.py_func):
        done, stamps = np.array([0 if under_way else NEVER, NEVER, NEVER]), np.full(ROWS, NEVER)
        steps = Steps(
            done, stamps, np.zeros(ROWS, np.int64), 7, heralds, followed, PERIOD, lead, may_skip
        )
        found = judge_all(steps, *(np.array(column) for column in zip(*messages, strict=True)))
        ways.append((found, [each.tolist() for each in steps[:3]]))
    assert ways[0] == ways[1]


# The stepper


def feed(stepper: WatchedStepper, stamp: int, *kinds: type) -> list:
    """Answers to messages of a stamp, made by toys that speak for the writers of the kinds."""
    answers = []
    for kind in kinds or stepper.reads:
        writer = next(role for role in ROLES.values() if kind in role.writes)
        signal = toy(writer.name).create().speak((kind,))[0]
        numbers = shape_of(kind).flat(signal)
        answers += stepper.answers_to(kind, stamp, stepper.inbox.offer(kind, stamp, numbers))
    return answers


def numbers_of(answers: list) -> list:
    """Stamps and bytes of answers."""
    return [(answer.stamp, answer.frame.numbers.tobytes()) for answer in answers]


def test_a_node_that_answers_copies_the_stamp_and_repeats_itself_when_asked():
    stepper = WatchedStepper(toy("asr", (WheelTorqueRequest,)))
    first = feed(stepper, 3 * PERIOD)
    assert [answer.stamp for answer in first] == [3 * PERIOD]
    assert feed(stepper, 3 * PERIOD) == first
    assert stepper.stepped == [3 * PERIOD]
    assert feed(stepper, 2 * PERIOD) == []


def test_a_node_that_integrates_speaks_first_and_is_one_answer_ahead():
    """Its state at t_k follows from what it read up to t_k-1 (roles.py).

    A repetition gives both answers.
    """
    stepper = WatchedStepper(toy("steering_column", (DriverCommand, WheelStates)))
    initial = feed(stepper, 0, WheelStates)
    assert [answer.stamp for answer in initial] == [0]
    after = feed(stepper, 0, DriverCommand)
    assert [answer.stamp for answer in after] == [PERIOD]
    assert after[0].frame.numbers != initial[0].frame.numbers
    assert feed(stepper, 0, WheelStates) == initial + after
    assert feed(stepper, 0, DriverCommand) == []


def test_a_late_message_after_a_reset_says_nothing_about_the_new_run():
    """A column at rest again does not announce its first state for an older instant."""
    stepper = WatchedStepper(toy("steering_column", (DriverCommand, WheelStates, TireForces)))
    feed(stepper, 5 * PERIOD)
    assert [answer.stamp for answer in feed(stepper, 0, WheelStates)] == [0]
    assert feed(stepper, 5 * PERIOD, TireForces) == []
    assert stepper.answer.stamp == 0


def test_a_joining_column_stands_still_until_it_can_step():
    """It has missed the driver's command of its first instant, which is not repeated later."""
    stepper = WatchedStepper(toy("steering_column", (DriverCommand, WheelStates)))
    answers = feed(stepper, 7 * PERIOD, WheelStates) + feed(stepper, 8 * PERIOD, WheelStates)
    assert [answer.stamp for answer in answers] == [7 * PERIOD, 8 * PERIOD]
    assert answers[0].frame.numbers[TIME + 1 :] == answers[1].frame.numbers[TIME + 1 :]
    assert [answer.stamp for answer in feed(stepper, 8 * PERIOD, DriverCommand)] == [9 * PERIOD]


def test_stamp_zero_makes_a_new_object():
    stepper = WatchedStepper(toy("driver", (BodyVelocity,)))
    first = numbers_of(feed(stepper, 0))
    feed(stepper, PERIOD)
    feed(stepper, 2 * PERIOD)
    assert numbers_of(feed(stepper, 0)) == first


def test_repetitions_go_down_the_graph_only():
    """Two nodes that read each other would otherwise repeat their answers for ever."""
    for name, role in ROLES.items():
        for signal in role.reads:
            writer = next(other.name for other in ROLES.values() if signal in other.may_write)
            mutual = any(s in ROLES[writer].reads for s in role.writes)
            if mutual and name != MASTER:
                back = any(s in upstream_signals(writer) for s in role.writes)
                assert not (back and signal in upstream_signals(name)), (name, writer)
    assert upstream_signals(MASTER) == frozenset()


def test_realtime_holds_the_inputs_over_steps_that_were_left_out():
    """Time must not slip: three periods at once are three steps with the same inputs."""
    kinds = (DriverCommand, WheelStates)
    skipping = WatchedStepper(toy("steering_column", kinds), may_skip=True)
    steady = WatchedStepper(toy("steering_column", kinds))
    feed(skipping, 0)
    after = feed(skipping, 3 * PERIOD)
    for stamp in range(0, 4 * PERIOD, PERIOD):
        expected = feed(steady, stamp)
    assert numbers_of(after[-1:]) == numbers_of(expected[-1:])
    assert after[-1].stamp == 4 * PERIOD


def test_realtime_holds_an_input_that_is_lost_and_goes_on():
    """Driver and column read each other: without that one lost message would stop both for ever."""
    stepper = WatchedStepper(toy("driver", (BodyVelocity, SteeringColumnState)), may_skip=True)
    feed(stepper, 0)
    assert feed(stepper, PERIOD, BodyVelocity) == []
    assert [answer.stamp for answer in feed(stepper, 2 * PERIOD, BodyVelocity)] == [PERIOD]
    assert [answer.stamp for answer in feed(stepper, 3 * PERIOD)] == [3 * PERIOD]


@pytest.mark.parametrize("lost", [DriverCommand, WheelStates])
def test_realtime_answers_to_no_node_that_is_gone(lost):
    """An input is held for a while only.

    Else its last torque would be repeated for ever, each time as a new one, and never be too old
    for the plant.
    """
    reads = (DriverCommand, WheelStates, SteeringColumnState)
    stepper = WatchedStepper(toy("electronic_differential", reads), may_skip=True)
    others = [kind for kind in reads if kind is not lost]
    feed(stepper, 0)
    answered = [answer.stamp for n in range(1, 60) for answer in feed(stepper, n * PERIOD, *others)]
    assert answered == [n * PERIOD for n in range(1, HELD // PERIOD + 1)]
    assert feed(stepper, 60 * PERIOD)[-1].stamp == 60 * PERIOD
    assert [answer.stamp for n in (61, 62) for answer in feed(stepper, n * PERIOD, *others)] == [
        61 * PERIOD
    ]


def test_realtime_goes_on_for_ever_where_it_integrates():
    """A column keeps its wheel.

    It has a time of its own, and what it says is no torque of the drives.
    """
    stepper = WatchedStepper(toy("steering_column", (DriverCommand, WheelStates)), may_skip=True)
    feed(stepper, 0)
    answered = [
        answer.stamp for n in range(1, 60) for answer in feed(stepper, n * PERIOD, WheelStates)
    ]
    assert answered == [n * PERIOD for n in range(2, 60)]


@pytest.mark.parametrize("period", [PERIOD, HELD // 2, 2 * HELD])
def test_realtime_holds_for_two_steps_whatever_their_period(period):
    box = HoldingInbox(
        Inputs((DriverCommand, WheelStates), period), frozenset({WheelStates}), neutral=False
    )
    for kind in box.reads:
        box.offer(kind, 0, [0.0] * shape_of(kind).size)
    box.take(0)
    for n in (1, 2, 3):
        box.offer(WheelStates, n * period, [0.0] * shape_of(WheelStates).size)
    assert box.complete() == 2 * period


def test_realtime_takes_messages_that_are_late_each_time():
    """A command that always misses its step stands in the next one."""
    box = HoldingInbox(
        Inputs((DriverCommand, WheelStates), PERIOD), frozenset({WheelStates}), neutral=True
    )
    sizes = {kind: shape_of(kind).size for kind in box.reads}
    for n in range(4):
        assert box.offer(WheelStates, (n + 1) * PERIOD, [0.0] * sizes[WheelStates]) is Arrival.NEW
        if n:
            assert box.complete() == n * PERIOD
            assert box.take(n * PERIOD).numbers[PLACES[DriverCommand].start] == n - 1
        arrival = box.offer(DriverCommand, n * PERIOD, [float(n)] * sizes[DriverCommand])
        assert arrival is (Arrival.OLD if n else Arrival.NEW)
        assert box.held.stamp_of(DriverCommand) == n * PERIOD


def test_realtime_integrates_with_zero_what_was_never_heard():
    stepper = WatchedStepper(toy("steering_column", (DriverCommand, WheelStates)), may_skip=True)
    assert [answer.stamp for answer in feed(stepper, 0, WheelStates)] == [0]
    assert feed(stepper, PERIOD, WheelStates)[-1].stamp == PERIOD and stepper.stepped == [0]


def test_realtime_lets_a_node_that_answers_step_once():
    """It has no time of its own, so nothing slips."""
    stepper = WatchedStepper(toy("driver", (BodyVelocity,)), may_skip=True)
    feed(stepper, 0)
    assert [answer.stamp for answer in feed(stepper, 3 * PERIOD)] == [3 * PERIOD]
    assert stepper.stepped == [0, 3 * PERIOD]


def test_the_plant_says_first_what_the_others_wait_for():
    """The driver answers first.

    A node sleeps until the input that comes last, the one that is published last.
    """
    order = sorted(ROLES["plant"].writes, key=arrival_place)
    assert order[0] is ROLES["driver"].reads[0]
    assert max((WheelStates, BodyVelocity, TireForces), key=arrival_place) is TireForces
    assert max((BodyPose, DriverCommand, SteeringColumnState), key=arrival_place) is DriverCommand


def test_integrating_nodes_are_followed_by_the_master():
    """Every other integrating role speaks to the master, else one of them could be left behind.

    The master reads something of an optional one where it is played, and hears none where it is
    not.
    """
    for name, role in ROLES.items():
        if role.optional:
            assert not set(role.writes) & set(toy(MASTER, (WheelTorqueCommand,)).method.inputs)
        elif role.kind is RoleKind.INTEGRATES and name != MASTER:
            assert set(role.writes) <= set(toy(MASTER, (WheelTorqueCommand,)).method.inputs)


def test_a_run_can_be_stepped_by_any_period():
    """Stamps are whole nanoseconds.

    A third of a millisecond is rounded once and exact from then on.
    """
    network = lossless(toy_graph(period=1e-3 / 3), 7)
    assert network.instants() == [step * 333_333 for step in range(8)]
    assert_each_stepped_once(network)
