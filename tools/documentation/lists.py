"""Scenarios and methods, a line each."""

from __future__ import annotations

from documentation.markdown import code, table
from documentation.own_methods import own_methods
from ev_msgs_py.contract.roles import ROLES
from ev_stack.scenarios.about import describe_scenario
from ev_stack.scenarios.files import scenario_names
from ev_study.studies.study import study_named, study_names


def scenario_table() -> str:
    """Every scenario with what it says about itself."""
    return table(
        ("scenario", "what it shows"),
        ((code(name), describe_scenario(name)) for name in scenario_names()),
    )


def study_list() -> str:
    """Every study with what it says about itself."""
    return table(
        ("study", "what it shows"),
        ((code(name), study_named(name).ABOUT) for name in study_names()),
    )


def method_table() -> str:
    """Every method with its role and the first line of its docstring; the default of each role comes in bold."""
    rows = []
    for role in ROLES.values():
        for name, method in own_methods(role.name).items():
            shown = f"**{code(name)}**" if name == role.default_method else code(name)
            rows.append((code(role.name), shown, method.about))
    return table(("node", "method", "what it does"), rows)
