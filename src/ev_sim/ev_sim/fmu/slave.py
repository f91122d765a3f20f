"""What runs inside an FMU: a car or a law behind the calls of FMI 2.0 co-simulation, by PythonFMU."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import units
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError
from ev_sim.fmu.export import read_content, versions
from ev_sim.interface.simulation import Simulation, SteppedLaw


class Slave(Fmi2Slave):
    """Steps a `Simulation` or a `SteppedLaw`; the content is in the folder of the resources.

    What is shown after a step is the instant to which it leads. A law shows what it answers to the inputs at the
    beginning of the step: coupled with a car, the law is to be stepped first, and its answer is the car's input for the
    step of the same interval.
    """

    author = "EV Control Stack maintainers"
    license = "Apache-2.0"

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        content = read_content(Path(self.resources))
        needs = ", ".join(f"{name} {number}" for name, number in versions().items())
        self.description = f"{content.law or 'car'} of {content.run.name}; needs Python with {needs} where it is run"
        self._law: SteppedLaw | None = None
        if content.law:
            configuration = content.run.configurations[content.law]
            self._law = SteppedLaw(configuration)
            self._period, inputs = configuration.period, self._law.inputs
            self._shown: Mapping[str, float] = dict.fromkeys(self._law.outputs, 0.0)
        else:
            self._car = Simulation(content.run, content.without, record=False)
            read = {signal for role in self._car.kept for signal in content.run.configurations[role].method.reads}
            taken = {name for signal in read if signal in TOPICS for name in TOPICS[signal].channels}
            self._period, inputs = self._car.period, tuple(name for name in self._car.inputs if name in taken)
            self._shown = self._car.frame
        self._given = dict.fromkeys(inputs, 0.0)
        self.default_experiment = DefaultExperiment(0.0, content.run.duration, stamps.to_seconds(self._period))
        left_out = () if self._law else self._car.inputs
        self._declare(inputs, [name for name in self._shown if name not in left_out])

    def _declare(self, inputs: Iterable[str], outputs: Iterable[str]) -> None:
        unit = units()

        def add(name: str, **how: Any) -> None:
            of_all = {"variability": Fmi2Variability.discrete, "description": f"[{unit[name]}]"}
            self.register_variable(Real(name, **of_all, **how), nested=False)

        for name in inputs:
            ways = {"getter": partial(self._given.get, name), "setter": partial(self._given.__setitem__, name)}
            add(name, start=0.0, causality=Fmi2Causality.input, **ways)
        for name in outputs:
            add(name, causality=Fmi2Causality.output, getter=lambda name=name: self._shown[name])

    def to_xml(self, model_options: Mapping[str, Any] | None = None) -> Any:
        """The description, with what PythonFMU leaves out.

        All outputs have a value before the first step; and a second instance in one process ends it in PythonFMU.
        """
        root = super().to_xml(dict(model_options or {}))
        root.find("CoSimulation").set("canBeInstantiatedOnlyOncePerProcess", "true")
        structure = root.find("ModelStructure")
        unknowns = SubElement(structure, "InitialUnknowns")
        for output in structure.find("Outputs"):
            SubElement(unknowns, "Unknown", output.attrib)
        return root

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One control period or several, for which the inputs are held.

        False, with a line in the log, for a step size in between and where a number is not finite: what is raised here
        would be fatal to the whole unit.
        """
        try:
            self._go_on(stamps.from_seconds(current_time), step_size)
        except ValueError as error:
            self.log(str(error), Fmi2Status.error)
            return False
        return True

    def _go_on(self, start: int, step_size: float) -> None:
        steps = stamps.from_seconds(step_size) / self._period
        if steps != int(steps) or steps < 1:
            period = stamps.to_seconds(self._period)
            raise ParameterError(f"step size {step_size:g} s is refused, allowed is {period:g} s or a multiple of it")
        for step in range(int(steps)):
            if self._law is not None:
                self._shown = self._law.answer(stamps.to_seconds(start + step * self._period), self._given)
            else:
                self._shown = self._car.step(self._given)
