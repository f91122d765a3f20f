"""The methods of this repository, without those of other packages that may be installed beside it."""

from __future__ import annotations

from ev_core.methods.method_record import Method
from ev_core.methods.register import methods_of, node_package
from ev_msgs_py.contract.roles import ROLES


def own_methods(role: str) -> dict[str, Method]:
    """The methods of a role that come with the packages of our nodes, by name."""
    own = {node_package(name) for name in ROLES}
    return {name: method for name, method in methods_of(role).items() if method.package in own}


def writing_methods(role: str, signal: type) -> list[str]:
    """Names of the methods of a role that write a signal, with the option that it takes for that."""
    found: list[str] = []
    for name, method in own_methods(role).items():
        if signal in method.writes:
            found.append(name)
            continue
        enough: list[set[str]] = []
        for switches, changed in method.law.options.items() if method.law else ():
            # What one switch brings, a second beside it does not bring anew.
            is_more = any(each <= {*switches} for each in enough)
            if signal in changed.get("writes", ()) and not is_more:
                enough.append({*switches})
                found.append(f"{name} with {' and '.join(switches)}")
    return found
