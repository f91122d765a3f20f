"""Names of configured graphs by what differs between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ev_core.lockstep.configuration import Configuration

_MOST = 3  # differences in a name
_METHOD = "method"


def names_of(graphs: Sequence[Mapping[str, Configuration]]) -> list[str]:
    """Name each by its methods, or values, that others have not; by numbers if these are many."""
    values: list[dict[str, Any]] = []
    for graph in graphs:
        of_one: dict[str, Any] = {}
        for role, configuration in graph.items():
            for name, value in configuration.values().items():
                # What all nodes have, such as the seed, counts once; each has a method of its own.
                of_one[f"{role}.{name}" if name == _METHOD else name] = value
        values.append(of_one)
    shared = [name for name in values[0] if all(name in each for each in values)]
    differing = [name for name in shared if any(each[name] != values[0][name] for each in values)]
    methods = [name for name in differing if name.endswith(f".{_METHOD}")]
    others = [name for name in differing if name not in methods]
    by_method = [", ".join(str(each[name]) for name in methods) for each in values]
    if len(set(by_method)) == len(by_method):
        return by_method
    named = []
    for each, method in zip(values, by_method, strict=True):
        parts = [f"{name} {each[name]}" for name in others]
        named.append(", ".join(filter(None, (method, *parts))))
    # Another car differs in dozens of numbers, and equal runs in none.
    if len(others) > _MOST or len(set(named)) < len(named):
        return [str(number) for number in range(1, len(named) + 1)]
    return named
