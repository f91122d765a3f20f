"""A package brings commands by an entry point.

A table that cannot be taken is named, and all others go on.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from types import ModuleType

import pytest

from ev_stack.command_line import offered_commands
from ev_stack.commands.program import perform


def greet(words: list[str]) -> None:
    """Print the words."""
    print("greeting", *words)


@pytest.fixture
def package(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The module that the entry point of an own package names."""
    module, real = ModuleType("own_commands"), offered_commands.offered

    def offered(group: str) -> Mapping[str, str]:
        return (
            {"aaa_own": "own_commands", **real(group)}
            if group == offered_commands.GROUP
            else real(group)
        )

    monkeypatch.setitem(sys.modules, "own_commands", module)
    monkeypatch.setattr(offered_commands, "offered", offered)
    offered_commands.offered_commands.cache_clear()
    yield module
    offered_commands.offered_commands.cache_clear()


def test_a_command_of_another_package_is_performed_and_listed(package: ModuleType, capsys):
    package.COMMANDS = {"greet": (f"{__name__}:greet", "print the words")}
    perform(["greet", "a", "b"])
    perform(["--help"])
    greeting, *lines = capsys.readouterr().out.splitlines()
    assert greeting == "greeting a b"
    assert lines[1].split()[0] == "run" and lines[-1].split() == ["greet", "print", "the", "words"]


@pytest.mark.parametrize(
    ("commands", "line"),
    [
        (None, "AttributeError: module 'own_commands' has no attribute 'COMMANDS'"),
        ({"run": ("own:run", "another run")}, "'run' is taken, expected another name"),
        ({"greet": ("own:greet",)}, "TypeError: "),
    ],
)
def test_a_table_that_cannot_be_taken_is_named_and_ours_go_on(
    package: ModuleType, capsys, commands, line
):
    if commands is not None:
        package.COMMANDS = commands
    perform(["--help"])
    *_, last = capsys.readouterr().out.splitlines()
    assert last.startswith(f"not loaded: commands of aaa_own: {line}")
    assert (
        offered_commands.offered_commands().commands["run"].place
        == "ev_stack.commands.run_scenario:main"
    )
    assert "greet" not in offered_commands.offered_commands().commands
