"""The commands of ev-stack: each package has a table of its own, which an entry point names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import NamedTuple

from ev_core.methods.offered import offered
from ev_msgs_py.packages import OURS

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


@cache
def commands() -> Mapping[str, Command]:
    """All commands by name: ours first, in the order of packages and of their tables."""
    packages = sorted(offered(GROUP), key=lambda name: OURS.index(name) if name in OURS else len(OURS))
    tables = [import_module(offered(GROUP)[package]).COMMANDS for package in packages]
    return {name: Command(*each) for table in tables for name, each in table.items()}
