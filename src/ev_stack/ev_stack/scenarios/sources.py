"""The values that files and the command line give to the nodes of a run, with their origin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.methods.law_error import LawError
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides

_FILE = "file"  # how the names of parameters that name files end


class Sources:
    """Places that give values to the nodes of one run; `given` has by role the values of each.

    The places are the files in their order and, behind them, the command line. Of several values
    for one parameter the last one counts.
    """

    def __init__(
        self, namespace: str, files: Sequence[ParameterFile], overrides: Overrides
    ) -> None:
        self.namespace = namespace
        self.files = files
        self.given: dict[str, list[dict[str, Any]]] = {}
        for role in ROLES:
            places = [file.values_for(f"{namespace}/{role}") for file in files]
            commanded = {}
            for node, name, value in overrides.all_values:
                if node in ("*", role):
                    commanded[name] = value
            self.given[role] = [*places, commanded]

    def values(self, role: str) -> dict[str, Any]:
        """The values that count, by name."""
        found: dict[str, Any] = {}
        for values in self.given[role]:
            found |= values
        return found

    def place(self, role: str, name: str) -> int:
        """The number of the place with the value that counts; -1 if none gives one."""
        places = [number for number, values in enumerate(self.given[role]) if name in values]
        return places[-1] if places else -1

    def configured(
        self, role: str, values: Mapping[str, Any], extra: type | None = None
    ) -> Configuration:
        """Configure a node; a refusal names it, and the file that gives the value that counts."""
        try:
            configuration = configure(role, values, extra)
            self._refuse_beside_files(configuration)
        except LawError:  # its line names the role, and its cause is kept
            raise
        except ParameterError as error:
            place = self.place(role, error.parameter)
            # A value of the command line has been seen.
            origin = f" ({self.files[place].path})" if 0 <= place < len(self.files) else ""
            raise ParameterError(f"{role}: {error}{origin}") from None
        return configuration

    def _refuse_beside_files(self, configuration: Configuration) -> None:
        """ParameterError for a value after or beside a file that has it: it would do nothing."""
        role, names = configuration.role, configuration.from_files
        command_line = len(self.files)
        for file in names:
            if not file.endswith(_FILE):
                continue
            for name in names:
                if name == file or not name.startswith(file.removesuffix(_FILE)):
                    continue
                place = self.place(role, name)
                # A value before the file is one that the file is meant to replace.
                if place > self.place(role, file) or place == command_line:
                    raise ParameterError(
                        f"parameter {name} is refused: {file} has it, expected {file} '' beside it",
                        name,
                    )
