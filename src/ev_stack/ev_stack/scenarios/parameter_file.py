"""ROS parameter files as ROS reads them: which values they give to a node of a given full name."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping
from copy import copy
from pathlib import Path
from typing import Any

import yaml

from ev_core.parameters.data_file import TEXT, TextOfFile, read_data
from ev_core.parameters.section import matches
from ev_msgs_py.refusal import ParameterError

_DEEPEST = 100  # brackets in brackets: the parser in C would overflow its stack
_SECTION = "ros__parameters"


class _Loader(yaml.CSafeLoader):
    """YAML as ROS reads it: 1e-3 is a number, a text in YAML 1.1; a key stands once."""

    def construct_yaml_int(self, node: yaml.ScalarNode) -> Any:
        """A number; 1:30 is none to ROS, and to the base of sixty a long one takes hours."""
        return node.value if ":" in node.value else super().construct_yaml_int(node)

    def construct_yaml_float(self, node: yaml.ScalarNode) -> Any:
        """The same."""
        return node.value if ":" in node.value else super().construct_yaml_float(node)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if key.value in seen:
                raise yaml.MarkedYAMLError(
                    problem=f"{named(key.value)} is listed twice", problem_mark=key.start_mark
                )
            seen.add(key.value)
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"),
    list("-+.0123456789"),
)


_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)
_Loader.add_constructor("tag:yaml.org,2002:float", _Loader.construct_yaml_float)


def named(key: object) -> str:
    """A key as an error may show it: what is no name may be a line of another file."""
    return str(key) if re.fullmatch(r"[\w/*. -]{1,80}", str(key)) else "a key that is no name"


def read_yaml(text: str) -> Any:
    """The content of a YAML text; yaml.YAMLError if it is none, or if a key stands in it twice."""
    try:
        _refuse_aliases_and_depth(text)
        return yaml.load(text, _Loader)
    except yaml.YAMLError:
        raise
    # what looks like a date or an octal number and is none, a list as a key, and the like
    except Exception as error:
        raise yaml.YAMLError(str(error)) from None


def _refuse_aliases_and_depth(text: str) -> None:
    """Refuse aliases, which ROS does not know: with some lines of them a text means gigabytes."""
    depth = 0
    # Events, before anything is built of them.
    for event in yaml.parse(text, _Loader):
        if isinstance(event, yaml.AliasEvent):
            raise yaml.MarkedYAMLError(
                problem="an alias, expected what it stands for", problem_mark=event.start_mark
            )
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(
            event, yaml.CollectionEndEvent
        )
        if depth > _DEEPEST:
            raise yaml.YAMLError("it is nested too deeply")


# written without the mark
yaml.SafeDumper.add_representer(TextOfFile, yaml.SafeDumper.represent_str)


class ParameterFile:
    """The sections of one ROS parameter file.

    ParameterError, in one line that names the file, if it is missing, is no YAML or is no ROS
    parameter file.
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
            # No quotation of the text: it may be a line of a file that is none of ours.
            what = f": {error.problem}" if isinstance(error, yaml.MarkedYAMLError) else ""
            raise ParameterError(f"{path}: not readable as YAML{where}{what}") from None
        if not isinstance(content, dict):
            raise ParameterError(
                f"{path}: a ROS parameter file has sections such as '/**/driver:', "
                "this one has none"
            )
        self.sections = dict(self._sections(content))

    def _sections(self, content: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
        for pattern, section in content.items():
            is_alone = isinstance(section, dict) and list(section) == [_SECTION]
            if not (is_alone and isinstance(section[_SECTION], dict)):
                shown = repr(named(pattern))
                raise ParameterError(
                    f"{self.path}: section {shown} does not hold '{_SECTION}:' with parameters"
                )
            values = flattened(section[_SECTION])
            yield str(pattern), {name: marked(name, value, self.path) for name, value in values}

    def names(self) -> set[str]:
        """The dotted names in all sections."""
        return {name for section in self.sections.values() for name in section}

    def without(self, prefix: str, patterns: Collection[str]) -> ParameterFile:
        """Copy of the file without the parameters with this prefix in these sections."""
        made = copy(self)
        made.sections = dict(self.sections)
        for pattern in patterns:
            section = self.sections[pattern].items()
            kept = {name: value for name, value in section if not name.startswith(prefix)}
            made.sections[pattern] = kept
        return made

    def values_for(self, node: str, by_name: bool = False) -> dict[str, Any]:
        """Dotted names and values for a node by its full name; of several the last one counts.

        With `by_name` only sections count that name the node, not those for all nodes.
        """
        values: dict[str, Any] = {}
        for pattern, section in self.sections.items():
            if matches(pattern, node) and not (by_name and pattern.endswith("*")):
                values.update(section)
        return values


# parameters that may name a file
_ARE_FILES = re.compile(r"(.*\.)?(\w+_)?(file|database|vehicle|method)")


def marked(name: str, value: Any, file: Path) -> Any:
    """Mark the texts of a value as those of a file: paths first mean files beside it."""
    if isinstance(value, dict):
        return {key: marked(str(key), each, file) for key, each in value.items()}
    if isinstance(value, list):
        return [marked(name, each, file) for each in value]
    if not isinstance(value, str):
        return value
    beside = file.parent.absolute() / value
    # What leads out of the folder is refused where it is read, by the name in the file.
    may_be_file = _ARE_FILES.fullmatch(name) and beside.suffix and ".." not in beside.parts
    if may_be_file and os.path.isfile(beside):
        value = str(beside)
    return TextOfFile.of(value, file)


def flattened(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Nested parameters under their dotted names."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from flattened(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
