"""Every parameter with default, unit, allowed values, description and source."""

from __future__ import annotations

from typing import Any

from documentation.markdown import code, codes, table
from documentation.own_methods import own_methods
from ev_bench.inverter.device import InverterNodeParameters
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_core.methods.common_parameters import CommonParameters
from ev_core.parameters.declaration import Entry, entries
from ev_core.sensors.row import QUANTITIES
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.topics import TOPICS
from ev_nodes.master.real_time import MasterParameters
from ev_stack.recording.run_recorder import RecorderParameters
from ev_stack.scenarios.about import ScenarioParameters

COLUMNS = ("name", "default", "unit", "allowed", "description", "source")
_MANY = 5  # from so many elements on, a default that is every choice is written as "all"
_ANY = {float: "any number", int: "any whole number", bool: "true, false", str: "any text"}


def common_parameters() -> str:
    """What every node has, besides the vehicle and its method."""
    return _table(
        [entry for entry in entries(CommonParameters) if not entry.name.startswith("vehicle.")]
    )


def vehicle_parameters() -> str:
    """The vehicle description."""
    return _table(entries(Vehicle, "vehicle."))


def master_parameters() -> str:
    """How time runs."""
    return _table(entries(MasterParameters))


def recorder_parameters() -> str:
    """What the recorder is told."""
    return _table(entries(RecorderParameters))


def gateway_parameters() -> str:
    """How the gateway speaks for the controller."""
    return _table(entries(GatewayParameters))


def inverter_parameters() -> str:
    """The devices of the bench."""
    return _table(entries(InverterNodeParameters))


def scenario_parameters() -> str:
    """What a scenario says about itself."""
    return _table(entries(ScenarioParameters))


def method_parameters() -> str:
    """The parameters of every method of every role."""
    sections = []
    for role in ROLES.values():
        for name, method in own_methods(role.name).items():
            default = " (default)" if name == role.default_method else ""
            sections.append(
                f"### {role.name}:"
                f" {name}{default}\n\n{method.about}\n\n{_of_method(method.parameters)}"
            )
    return "\n".join(sections)


def sensor_parameters() -> str:
    """What each sensor measures, and the errors that every one of them may have."""
    columns = ("parameters", "of", "topic", "fields", "unit", "largest error")
    rows = [
        (
            code(f"sensors.{quantity.name}.*"),
            next(role.name for role in ROLES.values() if quantity.signal in role.writes),
            code(TOPICS[quantity.signal].name),
            codes(quantity.fields),
            quantity.unit,
            f"{quantity.largest:g}",
        )
        for quantity in QUANTITIES
    ]
    errors = [_error_row(entry) for entry in entries(QUANTITIES[0].parameters)]
    return f"{table(columns, rows)}\n{table(('parameter', 'default', 'unit', 'allowed', 'description'), errors)}"


def _error_row(entry: Entry) -> tuple[str, ...]:
    """A parameter that all sensors have, in words where its unit and range are those of the quantity."""
    spec = entry.spec
    unit, allowed = spec.unit, _allowed(entry)
    if unit == QUANTITIES[0].unit:
        unit, allowed = (
            "of the sensor",
            "largest error either way" if spec.low else "0 to largest error",
        )
    return code(entry.name), _default(entry), unit, allowed, spec.about


def _of_method(parameters: type) -> str:
    found = entries(parameters)
    return _table(found) if found else "No parameters.\n"


def _table(of: Any) -> str:
    return table(COLUMNS, map(_row, of))


def _row(entry: Entry) -> tuple[str, ...]:
    spec = entry.spec
    about = f"{spec.about} (fixed at start)" if spec.read_only else spec.about
    return code(entry.name), _default(entry), spec.unit, _allowed(entry), about, spec.source


def _default(entry: Entry) -> str:
    if not entry.is_array:
        return code(_number(entry.default))
    if len(entry.default) >= _MANY and entry.default == entry.spec.choices:
        return "all"
    return code(f"[{', '.join(map(_number, entry.default))}]")


def _number(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value) or '""'


def _allowed(entry: Entry) -> str:
    spec = entry.spec
    if spec.choices:
        return codes(spec.choices)
    if spec.low is None and spec.high is None:
        return _ANY[entry.type]
    if spec.high is None:
        return f"at least {_number(spec.low)}"
    if spec.low is None:
        return f"at most {_number(spec.high)}"
    return f"{_number(spec.low)} to {_number(spec.high)}"
