"""Processor in the loop: a law as a program on another processor, in lockstep with the graph.

How it works: the method of the role gets another factory, which makes a `ProcessorPart`. The graph
steps it as any other part: it sends the inputs of an instant to the program and puts the answer
into the frame.
"""

from __future__ import annotations

import shlex
import shutil
import tempfile
import weakref
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from ev_core.lockstep.parts import restarts
from ev_core.methods.method_record import Method
from ev_core.methods.part import CalledBack
from ev_doors.export.content import Content
from ev_doors.export.counting import counted
from ev_doors.export.program import Program, build_program
from ev_doors.export.targets import TARGETS, target_of
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.frame import PLACES, Frame
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.scenarios.records import Run

# Emulated here; anything else is the command of a program on a processor of the user's.
EMULATED = {
    name.removesuffix("-linux"): name
    for name, target in TARGETS.items()
    if target.system != "Windows"
}


class OnProcessor:
    """Factory of the parts of a role that runs as a program.

    It runs on a processor of `EMULATED`, or by a command.

    Sensors and faults of the role stay here, behind the program. ParameterError, in one line, for a
    role that integrates, one that a fault restarts, a processor that cannot be emulated, and a
    command that is none.
    """

    def __init__(self, run: Run, role: str, where: str) -> None:
        if role not in run.configurations:
            raise unknown_name("role", role, run.configurations)
        configuration = run.configurations[role]
        if ROLES[role].kind is not RoleKind.ANSWERS:
            raise ParameterError(f"processor: {role} is refused, expected roles that answer")
        if restarts(configuration):
            raise ParameterError(
                f"processor: {role} has a fault `restarted`, which a program elsewhere cannot have"
            )
        method = configuration.method
        # The same attributes as the factory of methods that this replaces.
        self.writes, self.requires, self.mirrored = method.writes, method.requires, method.mirrored
        self.role, self.where, self._words = role, where, _words(where)
        # Bare: sensors and faults stay here, and would otherwise be applied twice.
        self.content = Content(run, only=[role], bare=True)
        self._why_not_counted = ""
        if where in EMULATED:
            target = target_of(EMULATED[where])
            # Before the run: the program is built and started only with the first step.
            if target.emulator and not shutil.which(target.emulator[0]):
                raise ParameterError(
                    f"processor {where}: {target.emulator[0]} is not installed; Debian has it in "
                    f"{'qemu-system-arm' if target.board else 'qemu-user'}"
                )

    @cached_property
    def command(self) -> list[str]:
        """The words that start the program, which is built for a processor of `EMULATED`."""
        if self.where not in EMULATED:
            return self._words
        self._folder = tempfile.TemporaryDirectory()
        folder, target = Path(self._folder.name), TARGETS[EMULATED[self.where]]
        command = build_program(self.content, target, folder)
        if not target.emulator or target.board:  # a board counts by itself
            return command
        try:
            return counted(command, folder)
        except ParameterError as error:  # the run needs no instructions
            self._why_not_counted = str(error)
            return command

    def __call__(self, parameters: Any, vehicle: Any, period: float) -> None:
        """There is no object here."""

    def part(self, method: Method, made: None) -> ProcessorPart:
        """Make the part that plays the role; the program starts with its first step."""
        self._part = ProcessorPart(self)
        return self._part

    @property
    def report(self) -> str:
        """Cost of the steps of the last part, in words."""
        begin = f"{self.content.run.name}: {self.role} on {self.where}"
        try:
            took = self._part.program.measured
        except ParameterError as error:  # it has ended since
            return f"{begin}: {error}"
        instructions = f"{took.instructions_a_step} instructions a step"
        if took.error:
            instructions = (
                f"instructions not counted: {self._why_not_counted or took.why_not_counted}"
            )
        per_step = took.nanoseconds / max(took.steps, 1) / 1000.0
        return (
            f"{begin}: {took.steps} steps of {per_step:.3g} us, {took.stack} bytes of stack,"
            f" {took.code} of code, {took.constants} of constants and state; {instructions}"
        )


def _words(command: str) -> list[str]:
    """Split a command; ParameterError for an empty one and an open quotation mark."""
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise ParameterError(
            f"processor {quoted(command)} is refused: {str(error).lower()}"
        ) from None
    if not words or not words[0]:
        raise ParameterError(
            f"processor {quoted(command)} is refused, expected the command of a program"
        )
    return words


class ProcessorPart(CalledBack):
    """Plays a role by the answers of a program; the state is that of the program, as bytes."""

    def __init__(self, on: OnProcessor) -> None:
        self._on, content = on, on.content
        self._inputs = [channel.place for channel in content.inputs]
        self._outputs = [channel.place for channel in content.outputs]
        self._shapes = [(shape_of(signal), PLACES[signal]) for signal in on.writes]

    @cached_property
    def program(self) -> Program:
        """The running program, at rest."""
        program = Program(self._on.content, self._on.command)
        # Whatever becomes of the run, no emulator outlives its part.
        weakref.finalize(self, program.close)
        program.create()
        return program

    @property
    def state(self) -> bytes:
        """All that lasts between steps."""
        return self.program.state

    @state.setter
    def state(self, state: bytes) -> None:
        self.program.restore(state)

    def step(self, here: Frame, there: Frame) -> None:
        """One step of the program; SignalError if it refuses an input or a number is not finite."""
        status, outputs = self.program.step([here.numbers[place] for place in self._inputs])
        for place, value in zip(self._outputs, outputs, strict=True):
            there.numbers[place] = value
        # Before the status: a number that is not finite is the clearer reason.
        self.refuse_not_finite(there)
        if status:
            raise SignalError(f"{self._on.role} on {self._on.where}: status {status}, expected 0")

    def refuse_not_finite(self, there: Frame) -> None:
        """SignalError if a number that it wrote is not finite."""
        for shape, place in self._shapes:
            shape.refuse_not_finite(there.numbers[place].tolist())

    def notes(self) -> tuple[str, ...]:
        """Nothing: `OnProcessor.report` has what it has taken."""
        return ()


def with_processors(run: Run, wanted: dict[str, str]) -> tuple[Run, list[OnProcessor]]:
    """A run with some of its roles on processors, by role; ParameterError as above."""
    made = [OnProcessor(run, role, where) for role, where in wanted.items()]
    changed = dict(run.configurations)
    for each in made:
        configuration = changed[each.role]
        changed[each.role] = replace(
            configuration, method=replace(configuration.method, factory=each)
        )
    return replace(run, configurations=changed), made
