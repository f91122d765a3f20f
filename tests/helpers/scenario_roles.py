"""Configurations of a role in the scenarios."""

from __future__ import annotations

from ev_core.lockstep.configuration import Configuration
from ev_stack.scenarios.scenario import load_scenario


def configurations_in(scenario: str, role: str) -> list[Configuration]:
    """Those of a role in the runs of a scenario, each once.

    Many runs differ in other roles only.
    """
    found: list[Configuration] = []
    for run in load_scenario(scenario).runs:
        if run.configurations[role] not in found:
            found.append(run.configurations[role])
    return found
