"""An export as a program on this or another processor, stepped over its standard input and output.

How it works: a request is written while answers are read, by `select`, since a pipe takes only so
much: to wait for one direction alone could last for ever. The program names its protocol and the
hash of its export first, so one that was built from something else is refused.

The requests are those of the program's source, NAME_program.c, byte by byte.
"""

from __future__ import annotations

import errno
import os
import select
import signal
import struct
import subprocess
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

import numpy as np

from ev_doors.export.content import Content
from ev_doors.export.library import PROTOCOL, Library
from ev_doors.export.targets import Target
from ev_msgs_py.refusal import ParameterError

# Without fused products, as in `targets.OPTIONS`: the bits are those of every other compiler.
_OPTIONS = ("-std=gnu99", "-O2", "-ffp-contract=off")
_NAME = "model"
PATIENCE = 60.0  # s, with a program that does not answer
_AT_ONCE = 65536  # bytes that are read or written
_VERSION, _IDENTITY, _STATUS = struct.Struct("<I"), struct.Struct("<Q3I"), struct.Struct("<i")
_MEASURED = struct.Struct("<3Qi3I")
# by error numbers of Linux, as they come from perf_event_open and from the program
_NOT_COUNTED = {
    errno.EACCES: "the kernel there does not allow it (kernel.perf_event_paranoid)",
    errno.EPERM: "the kernel there does not allow it",
    errno.ENOENT: "the processor there shows no counter of them",
    errno.EOPNOTSUPP: "the processor there shows no counter of them",
    errno.ENOSYS: "the system there has no counter of them",
    errno.EBUSY: "the counter there did not count all the time",
    errno.ENODATA: "the counter there stands still",
}


class Measured(NamedTuple):
    """Cost of the steps of a program, and the size of its parts.

    Time [ns]; instructions, which mean nothing unless `error`, a number of Linux, is 0; bytes of
    the stack, of code, and of constants with states.
    """

    steps: int
    nanoseconds: int
    instructions: int
    error: int
    stack: int
    code: int
    constants: int

    @property
    def instructions_a_step(self) -> int:
        """The mean over all steps."""
        return round(self.instructions / max(self.steps, 1))

    @property
    def why_not_counted(self) -> str:
        """Why there are no instructions, in words; empty if there are."""
        return _NOT_COUNTED.get(self.error, os.strerror(self.error)) if self.error else ""


def build_program(content: Content, target: Target, folder: Path) -> list[str]:
    """Build the program in a folder, and return the command that starts it here.

    A program for another processor is started by an emulator.
    """
    library = Library(content, _NAME)
    objects = library.objects(target, folder)
    templates = ["model.h", "constants.h", "model.c", "program.c"]
    linking = [*target.linking]
    if target.board:
        templates.append("board.c")
        linking += ["-T", *map(str, library.write(folder, target, ["board.ld"]))]
    sources = library.write(folder, target, templates, **library.sizes(objects))
    program = target.program(
        [*objects, *sources[2:]], folder / f"{_NAME}_program", (*_OPTIONS, *linking)
    )
    return [*target.emulator, str(program)]


class Program:
    """A running program of an export; ParameterError if it does not start or is another export.

    Answers are a status, 0 where all is well, and the outputs.
    """

    def __init__(self, content: Content, command: Sequence[str]) -> None:
        self._content, self._command = content, command
        self._inputs = struct.Struct(f"<{len(content.inputs)}d")
        self._outputs = struct.Struct(f"<i{len(content.outputs)}d")
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                bufsize=0,
                start_new_session=True,
            )
        except (OSError, ValueError) as error:
            raise self._refused(getattr(error, "strerror", "") or "it does not start") from None
        # A program that is refused is ended; one that is ours goes on.
        with ExitStack() as unless_ours:
            unless_ours.callback(self.close)
            assert self._process.stdin is not None
            # A full pipe must not hold us up while the program waits for us to read.
            os.set_blocking(self._process.stdin.fileno(), False)
            # The version alone first, since what follows may have another size in another version.
            if self._asked(b"i", _VERSION.size) != _VERSION.pack(PROTOCOL):
                raise self._refused("it knows another version of the protocol: build it again")
            identity, *_, self._state_size = _IDENTITY.unpack(self._asked(b"", _IDENTITY.size))
            if identity != int(content.digest[:16], 16):
                raise self._refused("it is that of another export: build it again")
            unless_ours.pop_all()

    def create(self) -> tuple[int, list[float]]:
        """Set everything to rest, and return status and outputs."""
        return self._answered(b"c")

    def reset(self, seed: int) -> tuple[int, list[float]]:
        """Set everything to rest with another seed."""
        return self._answered(b"r" + struct.pack("<I", seed))

    def step(self, inputs: Sequence[float]) -> tuple[int, list[float]]:
        """One control period with these inputs."""
        return self._answered(b"s" + self._inputs.pack(*inputs))

    def set_parameter(self, index: int, value: float) -> int:
        """Change a parameter; a status."""
        (status,) = _STATUS.unpack(
            self._asked(b"p" + struct.pack("<Id", index, value), _STATUS.size)
        )
        return int(status)

    @property
    def state(self) -> bytes:
        """All that lasts."""
        return self._asked(b"g", self._state_size)

    def restore(self, state: bytes) -> tuple[int, list[float]]:
        """Go on from a state."""
        return self._answered(b"t" + state)

    @property
    def measured(self) -> Measured:
        """Cost of all steps so far."""
        return Measured(*_MEASURED.unpack(self._asked(b"m", _MEASURED.size)))

    def drive(self, steps: int) -> np.ndarray:
        """Outputs of a run without inputs from its start on, (steps + 1, outputs).

        Raises ParameterError if a step stops.
        """
        kind = np.dtype([("status", "<i4"), ("outputs", "<f8", (len(self._content.outputs),))])
        # All requests at once: waiting for each answer would take most of the time.
        answers = np.frombuffer(self._asked(b"c" + b"s" * steps, (steps + 1) * kind.itemsize), kind)
        for n in np.flatnonzero(answers["status"]):
            raise self._refused(f"status {answers['status'][n]} in step {n}")
        return answers["outputs"]

    def close(self) -> None:
        """End it; by force, with all that it has started, if it does not end with its input."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        try:
            self._process.wait(1.0)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()

    def __enter__(self) -> Program:
        return self

    def __exit__(
        self, kind: type | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def _answered(self, request: bytes) -> tuple[int, list[float]]:
        status, *outputs = self._outputs.unpack(self._asked(request, self._outputs.size))
        return status, outputs

    def _asked(self, request: bytes, size: int) -> bytes:
        to, by = self._process.stdin, self._process.stdout
        assert to is not None
        assert by is not None
        rest, answer = memoryview(request), bytearray()
        try:
            while rest or len(answer) < size:
                awaited = ([by] if len(answer) < size else [], [to] if rest else [], [])
                readable, writable, _ = select.select(*awaited, PATIENCE)
                if not (readable or writable):
                    raise self._refused(f"no answer within {PATIENCE:g} s")
                if writable:
                    rest = rest[os.write(to.fileno(), rest[:_AT_ONCE]) :]
                if readable:
                    if not (more := os.read(by.fileno(), min(size - len(answer), _AT_ONCE))):
                        break
                    answer += more
        # A pipe that is closed at the other end: the line below names it.
        except OSError:
            pass
        if rest or len(answer) < size:
            raise self._refused("it has ended, or does not know the protocol of here")
        return bytes(answer)

    def _refused(self, why: str) -> ParameterError:
        return ParameterError(f"program {' '.join(self._command)}: {why}")
