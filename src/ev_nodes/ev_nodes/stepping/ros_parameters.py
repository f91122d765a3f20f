"""Parameter dataclasses as ROS parameters: declared with description and range, refused with a reason."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import yaml
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

from ev_core.lockstep.finding import is_code
from ev_core.methods.common_parameters import OF_ROS
from ev_core.parameters.data_file import TextOfFile
from ev_core.parameters.declaration import Entry
from ev_core.parameters.section import matches
from ev_msgs_py.refusal import LINE, ParameterError, quoted, shown

_KINDS = {float: "DOUBLE", int: "INTEGER", bool: "BOOL", str: "STRING"}
_TYPES = {
    (kind, is_array): getattr(ParameterType, f"PARAMETER_{name}{'_ARRAY' * is_array}")
    for kind, name in _KINDS.items()
    for is_array in (False, True)
}
_NO_LIMIT = {float: 1e300, int: 2**62}
_SECTION = "ros__parameters"  # of a node in a parameter file
_QUALITY = "qos_overrides."
_METHOD, _LOG, _ADDRESS = "method", "bus.log", "bus.address"


def overrides(node: Node) -> dict[str, Any]:
    """The values of command line and parameter files for a node that declares its overrides by itself.

    ParameterError if a file of the command line means a node of this name, but none in this
    namespace, or if they are about the quality of service, which ROS would ignore here.
    """
    _refuse_file_of_another_namespace(node)
    given: Mapping[str, Any] = node.get_parameters_by_prefix("")
    for name in given:
        if name.startswith(_QUALITY):
            raise ParameterError(
                f"parameter {name} is refused: the quality of service of the topics is fixed", name
            )
    return {name: value.value for name, value in given.items() if not is_ros_own(name)}


def _refuse_file_of_another_namespace(node: Node) -> None:
    """ROS silently leaves a node its defaults then.

    A file without any section of its name may be that of others.
    """
    name, full = node.get_name(), node.get_fully_qualified_name()
    for flag, file in pairwise(sys.argv):
        if flag != "--params-file":
            continue
        # By libyaml: in Python a file of a run takes a quarter of a second, in every node.
        content = yaml.load(Path(file).read_text(), yaml.CSafeLoader)
        sections = list(_sections(content))
        named = [section for section in sections if section.rpartition("/")[2] == name]
        if named and not any(matches(section, full) for section in sections):
            raise ParameterError(
                f"{file}: {', '.join(named)} is not this node, expected {full} or /**/{name}"
            )


def _sections(content: Any, space: str = "") -> Iterator[str]:
    """The names of the sections; ROS lets a namespace stand as a group of its nodes."""
    if not isinstance(content, dict):
        return
    if _SECTION in content:
        yield space
    for name, below in content.items():
        if name != _SECTION:
            yield from _sections(below, f"{space}/{str(name).strip('/')}")


def given(node: Node, node_arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Values for a node, as `overrides`.

    ParameterError if a file chooses what only command line or Python may choose. That is code (a
    library, a law file), a network, and a log of the bus in a folder not below the working
    directory.
    """
    values = overrides(node)
    path: Any = values.get(_LOG)
    leads_out = isinstance(path, str) and (os.path.isabs(path) or ".." in Path(path).parts)
    if leads_out and not _is_given(_LOG, path, node_arguments):
        where = "a name below the working directory, on the command line any path"
        raise ParameterError(
            f"parameter {_LOG}: {quoted(path)} is refused, expected from a file {where}", _LOG
        )
    for name, may_be_refused in ((_METHOD, is_code), (_ADDRESS, bool)):
        value = values.get(name)
        if (
            isinstance(value, str)
            and may_be_refused(value)
            and not _is_given(name, value, node_arguments)
        ):
            values[name] = TextOfFile.of(value, Path("its parameter file"))
    return values


def _is_given(name: str, value: str, node_arguments: Mapping[str, Any]) -> bool:
    """Return whether a value is from the command line (-p NAME:=VALUE) or from the program that makes the node."""
    if any(
        each.name == name and each.value == value
        for each in node_arguments.get("parameter_overrides") or ()
    ):
        return True
    words = [*sys.argv, *(node_arguments.get("cli_args") or ())]
    assigned = [word.partition(":=") for flag, word in pairwise(words) if flag in ("-p", "--param")]
    return any(
        key.rpartition(":")[2] == name and text.strip("'\"") == value for key, _, text in assigned
    )


def is_ros_own(name: str) -> bool:
    """Return whether ROS itself declares a parameter of this name in every node."""
    return name.partition(".")[0] in OF_ROS


def _asked_for(changes: Sequence[Parameter]) -> dict[str, Any]:
    """The values of a change that are ours.

    ParameterError if ROS's own are among them, for ROS might refuse these.
    """
    ours = {change.name: change.value for change in changes if not is_ros_own(change.name)}
    if ours and len(ours) < len(changes):
        own = ", ".join(change.name for change in changes if is_ros_own(change.name))
        raise ParameterError(
            f"{own} is refused beside {', '.join(ours)}, expected each in a change of its own"
        )
    return ours


def declare(node: Node, entries: Sequence[Entry]) -> None:
    """Declare parameters with type, description, unit and range.

    The values are the defaults of the entries.
    """
    for name in overrides(node):
        # ROS has declared it from the overrides, without type and description.
        node.undeclare_parameter(name)
    for entry in entries:
        kind = Parameter.Type(_TYPES[entry.type, entry.is_array])
        value = list(entry.default) if entry.is_array else entry.default
        node.declare_parameter(
            entry.name,
            Parameter(entry.name, kind, value).value,
            descriptor(entry),
            ignore_override=True,
        )


def limit_of(value: float | None) -> float | None:
    """A limit of a described range, None where `descriptor` had none to describe."""
    return None if value is None or abs(value) in _NO_LIMIT.values() else value


def descriptor(entry: Entry) -> ParameterDescriptor:
    """The descriptor that `ros2 param describe` shows."""
    spec = entry.spec
    unit = f" [{spec.unit}]" if spec.unit else ""
    source = f" ({spec.source})" if spec.source else ""
    result = ParameterDescriptor(
        name=entry.name,
        type=_TYPES[entry.type, entry.is_array],
        description=f"{spec.about}{unit}{source}",
        additional_constraints=f"allowed: {spec.allowed}",
        read_only=spec.read_only,
        # ROS takes an empty array for one of bytes; our own check knows the type
        dynamic_typing=entry.is_array,
    )
    if not entry.is_array and (spec.low is not None or spec.high is not None):
        limit = _NO_LIMIT[entry.type]
        low = entry.type(-limit if spec.low is None else spec.low)
        high = entry.type(limit if spec.high is None else spec.high)
        if entry.type is float:
            result.floating_point_range = [
                FloatingPointRange(from_value=low, to_value=high, step=0.0)
            ]
        else:
            result.integer_range = [IntegerRange(from_value=low, to_value=high, step=1)]
    return result


def follow(
    node: Node, entries: Sequence[Entry], take_over: Callable[[dict[str, Any]], None]
) -> None:
    """Declare parameters, and give each change of them to `take_over`.

    Whatever that raises refuses the change.
    """
    declare(node, entries)

    def on_set(changes: list[Parameter]) -> SetParametersResult:
        try:
            if given := _asked_for(changes):
                take_over(given)
        except Exception as error:  # also of a law of the user's
            return SetParametersResult(
                successful=False, reason=shown(str(error) or repr(error), LINE)
            )
        return SetParametersResult(successful=True)

    node.add_on_set_parameters_callback(on_set)
