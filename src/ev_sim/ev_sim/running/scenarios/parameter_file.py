"""ROS parameter files as ROS reads them: which values they give to a node of a given full name."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from copy import copy
from pathlib import Path
from typing import Any

import yaml

from ev_msgs_py.parameters.data_file import TEXT, TextOfFile, read_data
from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.running.scenarios.yaml_text import named, read_yaml

_SECTION = "ros__parameters"
yaml.SafeDumper.add_representer(TextOfFile, yaml.SafeDumper.represent_str)  # written without the mark


class ParameterFile:
    """The sections of one ROS parameter file.

    ParameterError, in one line that names the file, if it is missing, is no YAML or is no ROS parameter file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            content = read_yaml(read_data(path, TEXT).decode())
        except OSError as error:
            raise ParameterError(f"{path}: {error.strerror}") from None
        except (yaml.YAMLError, UnicodeDecodeError) as error:
            line = getattr(getattr(error, "problem_mark", None), "line", None)
            where = f" in line {line + 1}" if line is not None else ""
            what = f": {error.problem}" if isinstance(error, yaml.MarkedYAMLError) else ""
            raise ParameterError(f"{path}: not readable as YAML{where}{what}") from None
        if not isinstance(content, dict):
            raise ParameterError(f"{path}: a ROS parameter file has sections such as '/**/driver:', this one has none")
        self.sections = dict(self._sections(content))

    def _sections(self, content: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
        for pattern, section in content.items():
            if not isinstance(section, dict) or list(section) != [_SECTION] or not isinstance(section[_SECTION], dict):
                shown = repr(named(pattern))
                raise ParameterError(f"{self.path}: section {shown} does not hold '{_SECTION}:' with parameters")
            values = flattened(section[_SECTION])
            yield str(pattern), {name: _marked(value, self.path) for name, value in values}

    def names(self) -> set[str]:
        """The dotted names in all sections."""
        return {name for section in self.sections.values() for name in section}

    def without(self, prefix: str, patterns: Collection[str]) -> ParameterFile:
        """The same file without the parameters whose names begin so in the sections of these names."""
        made = copy(self)
        made.sections = {
            pattern: {n: value for n, value in section.items() if pattern not in patterns or not n.startswith(prefix)}
            for pattern, section in self.sections.items()
        }
        return made

    def values_for(self, node: str, by_name: bool = False) -> dict[str, Any]:
        """Dotted parameter names and values for a node by its full name; later sections go before earlier ones.

        With `by_name` only sections count that name the node, not those for all nodes.
        """
        values: dict[str, Any] = {}
        for pattern, section in self.sections.items():
            if matches(pattern, node) and not (by_name and pattern.endswith("*")):
                values.update(section)
        return values


def matches(pattern: str, node: str) -> bool:
    """Whether a section name (`/**` any namespaces, `*` one token) means a node of this full name."""
    expression = re.escape(pattern if pattern.startswith("/") else f"/{pattern}")
    expression = expression.replace(r"/\*\*", r"(/\w+)*").replace(r"\*", r"\w+")
    return re.fullmatch(expression, node) is not None


def _marked(value: Any, file: Path) -> Any:
    """A value whose texts know that a file says them."""
    if isinstance(value, list):
        return [_marked(each, file) for each in value]
    return TextOfFile.of(value, file) if isinstance(value, str) else value


def flattened(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Nested parameters under their dotted names."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from flattened(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
