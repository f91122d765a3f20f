"""The methods of this repository, without those of other packages that may be installed beside it."""

from __future__ import annotations

from ev_msgs_py.lockstep.methods import Method, methods_of

PACKAGES = ("ev_control", "ev_sim")


def own_methods(role: str) -> dict[str, Method]:
    """The methods of a role that ev_sim and ev_control bring, by name."""
    found = methods_of(role)
    return {name: method for name, method in found.items() if method.documented.__module__.split(".")[0] in PACKAGES}


def writing_methods(role: str, signal: type) -> list[str]:
    """Names of the methods of a role that write a signal."""
    return [name for name, method in own_methods(role).items() if signal in method.writes]
