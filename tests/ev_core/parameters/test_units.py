"""Numbers with units at the boundary, and the schema that editors check files by."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest

from ev_core.parameters.data_file import files_in_config
from ev_core.parameters.values import ACCEPTED, build, number_of
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.descriptions import schema
from ev_stack.scenarios.parameter_file import read_yaml
from ev_stack.scenarios.scenario import Overrides, load_scenario

SCHEMA = schema()


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("80 km/h", "m/s", 80 / 3.6),
        ("-30deg", "rad", -math.pi / 6),
        ("1.5e3 mm", "m", 1.5),
        ("60 rpm", "rad/s", 2 * math.pi),
        ("20 %", "1", 0.2),
        ("4.5 t", "kg", 4500.0),
        ("1 kWh", "J", 3.6e6),
        ("100 N/deg", "N/rad", 100 * 180 / math.pi),
        ("3 N m", "N m", 3.0),
        ("3 Nm", "N m", 3.0),
        ("80 km/h", "m", None),
        ("80 kmh", "m/s", None),
        ("fast", "m/s", None),
        ("80", "m/s", None),
        ("2 1", "1", None),
    ],
)
def test_a_number_in_another_unit(text, unit, number):
    assert number_of(text, unit) == (None if number is None else pytest.approx(number, rel=1e-15))


def test_units_are_read_where_values_are_given():
    """Files, command line and Python share one check, and ranges hold behind it."""
    assert build(Vehicle, {"mass": "1.4 t", "wheelbase": "2405 mm"}) == Vehicle(
        mass=1400.0, wheelbase=2.405
    )
    chosen = [("plant", "initial_speed", "36 km/h"), ("driver", "speed_profile.speed", ["18 km/h"])]
    found = load_scenario("double_lane_change", Overrides(values=chosen)).runs[0].configurations
    assert found["plant"].parameters.initial_speed == 10.0
    assert found["driver"].parameters.speed_profile.speed == (5.0,)
    with pytest.raises(ParameterError) as error:
        build(Vehicle, {"mass": "1400 lb"})
    message = "parameter mass: '1400 lb' is refused, expected a number, 50 to 60000 kg, or a text of a number and one of "
    assert str(error.value) == f"{message}kg, t, g"
    with pytest.raises(
        ParameterError, match=r"^parameter mass: 0.02 is refused, expected 50 to 60000 kg$"
    ):
        build(Vehicle, {"mass": "20 g"})


def test_no_unit_is_accepted_for_itself_with_a_factor():
    assert not [unit for unit, others in ACCEPTED.items() if unit in others]


def errors(value: Any, by: dict[str, Any], where: str = "") -> list[str]:
    """List the keywords of our schema that a value breaks."""
    if by is True or "$ref" in by:
        return (
            []
            if by is True
            else errors(value, SCHEMA["$defs"][by["$ref"][8:].replace("%20", " ")], where)
        )
    if "anyOf" in by:
        return min((errors(value, each, where) for each in by["anyOf"]), key=len)
    kinds = {
        "object": dict,
        "array": list,
        "string": str,
        "boolean": bool,
        "integer": int,
        "number": (int, float),
    }
    if "type" in by and (
        not isinstance(value, kinds[by["type"]])
        or (isinstance(value, bool) and by["type"] != "boolean")
    ):
        return [f"{where}: {value!r} is no {by['type']}"]
    wrong = "enum" in by and value not in by["enum"]
    wrong |= (
        not by.get("minimum", -math.inf) <= value <= by.get("maximum", math.inf)
        if "minimum" in by
        else False
    )
    wrong |= "pattern" in by and re.search(by["pattern"], value) is None
    found = [f"{where}: {value!r}"] if wrong else []
    if isinstance(value, list):
        found += [error for each in value for error in errors(each, by["items"], where)]
    if isinstance(value, dict):
        patterns = by.get("patternProperties", {})
        for name, each in value.items():
            kinds = [by.get("properties", {}).get(name)] + [
                patterns[p] for p in patterns if re.search(p, name)
            ]
            meant = [kind for kind in kinds if kind is not None]
            if not meant and by.get("additionalProperties", True) is False:
                found.append(f"{where}.{name} is unknown")
            found += [error for kind in meant for error in errors(each, kind, f"{where}.{name}")]
    return found


@pytest.mark.parametrize("kind", ["scenarios", "vehicles"])
def test_our_own_files_keep_the_schema(kind):
    for path in files_in_config(kind).values():
        assert errors(read_yaml(path.read_text()), SCHEMA, path.name) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("/**/driver: {ros__parameters: {sed: 1}}", "./**/driver.ros__parameters.sed is unknown"),
        ("/**/driver: {ros__parameters: {seed: -1}}", "./**/driver.ros__parameters.seed: -1"),
        ("/**/plant: {ros__parameters: {initial_speed: fast}}", "initial_speed: 'fast'"),
        ("/**: {ros__parameters: {vehicle: {mass: 10.0}}}", "vehicle.mass: 10.0"),
        ("/**/asr: {ros__parameters: {method: on}}", "method: True"),
        ("/**/scenario: {ros__parameters: {vehcle: x}}", "vehcle is unknown"),
    ],
)
def test_the_schema_finds_what_the_stack_would_refuse(text, message):
    (found,) = errors(read_yaml(text), SCHEMA)
    assert message in found
