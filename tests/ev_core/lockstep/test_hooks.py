"""A class or function without a method of its role is refused in one line, not registered."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from ev_core.methods.hooks import Answering, Integrating, ReadingFiles, Reporting
from ev_core.methods.law import LawObject
from ev_core.methods.register import all_methods, method, methods_of
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueRequest


@dataclass(frozen=True, slots=True)
class NoParameters:
    """Nothing to choose."""


def refused(role: str, defined: type) -> str:
    with pytest.raises(TypeError) as error:
        method(role, "lacking")(defined)
    assert "lacking" not in methods_of(role)
    return str(error.value)


def test_a_class_that_answers_needs_a_step():
    class Lacking:
        parameters = NoParameters

    assert (
        refused("asr", Lacking)
        == "asr method lacking: class Lacking lacks step (see Answering in methods/hooks.py)"
    )


def test_a_class_that_integrates_needs_outputs_and_advance():
    class Lacking:
        parameters = NoParameters

        def step(self, request: WheelTorqueRequest) -> None: ...

    assert refused("plant", Lacking).startswith(
        "plant method lacking: class Lacking lacks outputs and advance ("
    )


def test_a_class_needs_parameters():
    class Lacking:
        def step(self, request: WheelTorqueRequest) -> None: ...

    assert "class Lacking lacks parameters (" in refused("asr", Lacking)


def test_a_law_that_integrates_needs_outputs():
    def lacking(driver: DriverCommand) -> None: ...

    with pytest.raises(
        TypeError,
        match="steering_column method lacking: a steering_column integrates, so its law needs",
    ):
        method("steering_column", "lacking", parameters=NoParameters)(lacking)
    assert "lacking" not in methods_of("steering_column")


@pytest.mark.parametrize(
    ("role", "name"), [(role, name) for role, named in all_methods().items() for name in named]
)
def test_objects_of_laws_have_the_same_hooks(role, name):
    """Objects of laws have the hooks of classes: nodes treat both alike."""
    law = all_methods()[role][name].law
    made = LawObject(law, build(law.parameters, {}), Vehicle(), 0.005)
    assert isinstance(made, Integrating if law.outputs else Answering)
    assert isinstance(made, Reporting) == (law.notes is not None)
    assert isinstance(law, ReadingFiles) == (law.load_files is not None)
