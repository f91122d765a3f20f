"""Texts of laws with every hook that an author may write, and what calls all of them."""

from __future__ import annotations

from pathlib import Path

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import hand_over, part_of
from ev_msgs_py.contract.frame import Frame

HEAD = """
import math
from dataclasses import dataclass, field

from ev_core.law import *


@dataclass(frozen=True, slots=True)
class P:
    window: float = parameter(2.0, unit="1", low=1.0, high=4.0, about="samples")


@dataclass(slots=True)
class S:
    now: list[float] = per_wheel(unit="N m")
    before: list[float] = per_wheel(unit="N m")


"""
FUNCTIONS = """
def prepare(parameters, vehicle, period):
    pass  # prepare


def start(p):
    pass  # start
    return S()


def notes(s):
    pass  # notes
    return (f"{s.now[0]:g} N m",)


def need(parameters, vehicle):
    pass  # need
    return ""


def load_files(parameters):
    pass  # load_files
    return parameters


@method("asr", "mine", prepare=prepare, start=start, notes=notes, needs=(need,), load_files=load_files)
def mine(p: P, s: S, request: WheelTorqueRequest) -> WheelTorqueCommand:
    pass  # step
    return WheelTorqueCommand(request.drive, request.brake)
"""
CLASS = """
@method("asr", "mine")
class mine:
    parameters = P

    def __init__(self, parameters, vehicle, period):
        pass  # init
        self._state = [0.0]

    @property
    def state(self):
        pass  # state
        return self._state

    @state.setter
    def state(self, row):
        pass  # set
        self._state = row

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        pass  # step
        return WheelTorqueCommand(request.drive, request.brake)

    def reports(self):
        pass  # reports
        return ("fine",)

    @staticmethod
    def load_files(parameters):
        pass  # load_files
        return parameters
"""
COMPILED = FUNCTIONS.replace("def mine", "@compilable\ndef mine").replace("    pass  # step\n", "")
FORMS = {"function": FUNCTIONS, "compiled": COMPILED, "class": CLASS}
HOOKS = [
    (form, line.partition("# ")[2])
    for form, text in FORMS.items()
    for line in text.splitlines()
    if "# " in line
]


def driven(file: Path, compiled: bool) -> None:
    """Everything that an author's text is called for."""
    configuration = configure("asr", {"method": str(file)})
    part, other, frame = part_of(configuration, compiled), part_of(configuration, compiled), Frame()
    part.step(frame, frame)
    part.notes()
    hand_over(part, other)
