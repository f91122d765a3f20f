"""The commands of ev-stack: each package has a table of its own, which an entry point names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import NamedTuple

from ev_core.methods.offered import offered
from ev_msgs_py.packages import OURS
from ev_msgs_py.refusal import quoted

GROUP = "ev_stack.commands"  # of entry points: the name of a package, and its module with COMMANDS


class Command(NamedTuple):
    """MODULE:FUNCTION that takes the words behind the name, and what it does."""

    place: str
    about: str

    def load(self) -> Callable[[list[str]], None]:
        """The function; its module is imported now, which may take half a second."""
        module, _, function = self.place.partition(":")
        performed: Callable[[list[str]], None] = getattr(import_module(module), function)
        return performed


class Offered(NamedTuple):
    """Commands by name, and one line for each package whose table cannot be taken."""

    commands: Mapping[str, Command]
    not_loaded: tuple[str, ...]


@cache
def offered_commands() -> Offered:
    """All commands: ours first, in the order of packages and of their tables."""
    packages = sorted(offered(GROUP), key=lambda name: OURS.index(name) if name in OURS else len(OURS))
    found: dict[str, Command] = {}
    not_loaded = []
    for package in packages:
        try:
            table = {name: Command(*each) for name, each in import_module(offered(GROUP)[package]).COMMANDS.items()}
        except Exception as error:  # whatever somebody's module raises: all other commands go on
            not_loaded.append(f"commands of {package}: {type(error).__name__}: {error}")
            continue
        if taken := [name for name in table if name in found]:
            not_loaded.append(f"commands of {package}: {quoted(taken[0])} is taken, expected another name")
            continue
        found |= table
    return Offered(found, tuple(not_loaded))
