"""Instruction counts of an emulated program by a plugin of qemu-user."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from ev_doors.export.targets import TARGETS
from ev_msgs_py.refusal import ParameterError

_SOURCE = Path(__file__).parent / "templates" / "qemu_count.c"
_HOST = TARGETS["x86_64-linux"]
_VERSIONS = range(1, 7)  # of the interface; an emulator takes some of them
_DESCRIPTOR = 100  # through which the program reads the count


def counted(command: Sequence[str], folder: Path) -> list[str]:
    """Command that starts an emulated program with the counting plugin in a folder.

    The last word of the command is the program. ParameterError, in one line, if its emulator cannot
    count.
    """
    _HOST.refuse_missing_compiler()
    *emulator, program = command
    # The first version that this emulator loads; it refuses all others at its start.
    for version in _VERSIONS:
        options = ("-O2", "-fPIC", "-shared", f"-DAPI={version}", f"-DDESCRIPTOR={_DESCRIPTOR}")
        plugin = _HOST.program([_SOURCE], folder / f"qemu_count_{version}.so", options)
        words = [*emulator, "-plugin", str(plugin), program, str(_DESCRIPTOR)]
        # A program ends with its input.
        if not (
            tried := subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True)
        ).returncode:
            return words
    line = (
        tried.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        or f"status {tried.returncode}"
    )
    raise ParameterError(f"{emulator[0]} does not take the plugin that counts: {line}")
