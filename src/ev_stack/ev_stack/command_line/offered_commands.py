"""The commands of ev-stack: each package has tables of its own, in a module that an entry point names.

How it works: `COMMANDS` of that module are the commands of `ev-stack`. `REVIEWS`, which it may
have, are what `ev-stack run` does by name besides driving a scenario. `STUDY`, which one package
has, drives a study by its name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import NamedTuple

from ev_core.methods.offered import offered
from ev_msgs_py.packages import OURS
from ev_msgs_py.refusal import quoted

GROUP = "ev_stack.commands"  # of entry points: the name of a package, and its module with COMMANDS
STUDIES = "ev_stack.studies"  # of entry points: the name of a study, and its module


class Command(NamedTuple):
    """MODULE:FUNCTION that takes words, and what it does."""

    place: str
    about: str

    def load(self) -> Callable[[list[str]], None]:
        """The function; its module is imported now, which may take half a second."""
        module, _, function = self.place.partition(":")
        performed: Callable[[list[str]], None] = getattr(import_module(module), function)
        return performed


class Offered(NamedTuple):
    """Commands and reviews by name, the driver of studies, a line for each package not loaded."""

    commands: Mapping[str, Command]
    reviews: Mapping[str, Command]
    study: Command | None
    not_loaded: tuple[str, ...]


@cache
def offered_commands() -> Offered:
    """All commands: ours first, in the order of packages and of their tables."""
    packages = sorted(
        offered(GROUP), key=lambda name: OURS.index(name) if name in OURS else len(OURS)
    )
    commands: dict[str, Command] = {}
    reviews: dict[str, Command] = {}
    study = None
    not_loaded = []
    for package in packages:
        try:
            module = import_module(offered(GROUP)[package])
            own_commands = {name: Command(*each) for name, each in module.COMMANDS.items()}
            own_reviews = {
                name: Command(*each) for name, each in getattr(module, "REVIEWS", {}).items()
            }
        except Exception as error:  # any error of a user's module: all other commands go on
            not_loaded.append(f"commands of {package}: {type(error).__name__}: {error}")
            continue
        if taken := [*(own_commands.keys() & commands), *(own_reviews.keys() & reviews)]:
            not_loaded.append(
                f"commands of {package}: {quoted(min(taken))} is taken, expected another name"
            )
            continue
        commands |= own_commands
        reviews |= own_reviews
        if study is None and hasattr(module, "STUDY"):
            study = Command(module.STUDY, "a study")
    return Offered(commands, reviews, study, tuple(not_loaded))
