"""The test sequence of the bench (dissertation, 4.3): six steps, and the emergency switch."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

SEQUENCE_STEPS = ("choose", "connect", "load_model", "start", "siemens_rev_0", "disconnect")
OBJECTS = ("both", "right", "left")


class Stage(IntEnum):
    """Progress of the sequence: the place of the next step in SEQUENCE_STEPS."""

    IDLE = 0
    CHOSEN = 1
    CONNECTED = 2
    LOADED = 3
    RUNNING = 4
    LOADS_OFF = 5


@dataclass(frozen=True, slots=True)
class Sequence:
    """State of a test; `chosen` is the object of control, one circuit or both."""

    stage: Stage = Stage.IDLE
    chosen: str = "both"
    emergency: bool = False

    @property
    def enabled(self) -> str:
        """Circuits with enabled inverters: those of the object, until the load machines go off."""
        return self.chosen if self.stage is Stage.RUNNING and not self.emergency else "none"

    def after(self, step: str, cooling: bool, chosen: str = "both") -> Sequence:
        """The sequence after a step; ValueError, with the reason, for one that is not due.

        The machines need their cooling from the first step on. After an emergency only `disconnect`
        is left.
        """
        if self.emergency:
            if step != "disconnect":
                raise ValueError(f"{step} is refused after an emergency stop, expected disconnect")
            return Sequence()
        due = SEQUENCE_STEPS[self.stage]
        if step != due:
            raise ValueError(f"{step} is refused, expected {due}")
        if not cooling and step != "disconnect":
            raise ValueError(f"{step} is refused while the cooling is off")
        if step == "choose":
            return Sequence(Stage.CHOSEN, chosen)
        return Sequence() if step == "disconnect" else replace(self, stage=Stage(self.stage + 1))

    def stopped(self) -> Sequence:
        """The sequence after the emergency switch."""
        return replace(self, emergency=True)


def begun(enabled: str) -> Sequence:
    """Sequence of a bench that its parameters have enabled, as in runs without an operator."""
    return Sequence() if enabled == "none" else Sequence(Stage.RUNNING, enabled)
