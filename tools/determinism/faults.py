"""Faults of every kind and seeds of runs, drawn: whatever goes wrong in a run, all ways of running show the same."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import Any

from ev_core.faults.fault import KINDS, OF_SIGNALS, Kind
from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario

Changes = Sequence[tuple[str, str, Any]]  # as in Overrides.values, the seed of all nodes first
_ATTEMPTS = 20
_LARGEST = 3.0  # in the unit of the number: enough to be felt, and the car still drives


def run_with(scenario: str, name: str, seconds: float, changes: Changes) -> Run:
    """A run of a scenario with a seed and faults; ParameterError if it cannot have one of them."""
    return load_scenario(scenario, Overrides(values=changes, duration=seconds), only=(name,)).runs[
        0
    ]


def drawn_changes(
    scenario: str, name: str, seconds: float, trial: int, seed: int
) -> tuple[Changes, str]:
    """Faults that a run can have and that leave all its numbers finite, a seed, and its hash offline with them.

    The kinds take turns; where a run seems to have no place for a kind, another kind is drawn.
    """
    chance = random.Random(f"{seed} {trial} {scenario} {name}")
    configurations = run_with(scenario, name, seconds, ()).configurations
    kinds = list(KINDS)
    wanted = kinds[trial // 2 % len(kinds)]  # every other trial has faults
    refused = 0
    while True:
        faults: dict[str, list[str]] = {}
        for kind in (wanted, chance.choice(kinds)):
            role, text = _drawn(kind, KINDS[kind], configurations, seconds, chance)
            faults.setdefault(role, []).append(text)
        try:
            changes = [
                ("*", "seed", trial),
                *((role, "faults", texts) for role, texts in faults.items()),
            ]
            run = run_with(scenario, name, seconds, changes)
            return changes, signal_hash(run_offline(run.configurations, run.duration))
        except (ParameterError, SignalError):
            refused += 1
            wanted = wanted if refused < _ATTEMPTS else chance.choice(kinds)


def _drawn(
    name: str,
    kind: Kind,
    configurations: Mapping[str, Configuration],
    seconds: float,
    chance: random.Random,
) -> tuple[str, str]:
    if name in OF_SIGNALS:
        able = [
            r for r in configurations if name != "restarted" or ROLES[r].kind is RoleKind.ANSWERS
        ]
        role = chance.choice(able)
        topic = TOPICS[chance.choice(configurations[role].method.writes)]
        where = (
            topic.name
            if name == "restarted"
            else chance.choice((topic.name, chance.choice(topic.channels)))
        )
        channels = [
            c for signal in configurations[role].method.writes for c in TOPICS[signal].channels
        ]
        if name == "swapped":
            where = ",".join(chance.choices(channels, k=2))
        elif name == "tilted":
            role, where = "plant", f"imu.{chance.choice(('longitudinal', 'lateral'))}_acceleration"
    else:
        role, where = (
            "plant",
            "battery" if name == "battery_share" else chance.choice(("all", *WHEEL_NAMES)),
        )
    value = (
        f" {min(chance.uniform(max(kind.low, -_LARGEST), min(kind.high, _LARGEST)), kind.high):.3g}"
    )
    begin, end = sorted(round(chance.uniform(0.0, seconds), 2) for _ in range(2))
    return (
        role,
        f"{name} {where}{value if kind.has_value else ''} from {begin:g} until {end + 0.1:g}",
    )
