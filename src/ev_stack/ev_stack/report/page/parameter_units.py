"""The units of parameters, by the names of their nodes and methods, for what a page lists of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.register import methods_of
from ev_core.parameters.declaration import Entry
from ev_core.parameters.values import entries_by_name
from ev_core.sensors.row import sensors_for
from ev_msgs_py.contract.roles import ROLES
from ev_nodes.master.real_time import MasterParameters


def unit_of(node: str, parameter: str, method: str = "") -> str:
    """The unit of a parameter of a node with this method.

    Empty where it is not known, or others have other units.
    """
    # Without a known method all methods of the role are looked at, which may disagree.
    found = {of[parameter].spec.unit for of in _described(node, method) if parameter in of}
    return found.pop() if len(found) == 1 else ""


@cache
def _described(node: str, method: str) -> tuple[Mapping[str, Entry], ...]:
    shared = (entries_by_name(CommonParameters), entries_by_name(MasterParameters))
    if node not in ROLES:
        return shared
    known = methods_of(node)
    own = [known[method]] if method in known else known.values()
    sensors = entries_by_name(sensors_for(ROLES[node].writes), "sensors.")
    return (*shared, *(entries_by_name(each.parameters) for each in own), sensors)
