"""FMUs by PythonFMU: how one is written, and what runs inside it, behind the calls of FMI 2.0 co-simulation.

An FMU is PythonFMU's binary, a module of three lines and the content: every parameter of every role, so that it hangs
on no file of scenario or car.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, FmuBuilder, Real
from pythonfmu.enums import Fmi2Status

from ev_core.lockstep.configuration import configure
from ev_core.nodes.master.real_time import MasterParameters
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import units
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.interface.simulation import Simulation, SteppedLaw
from ev_sim.recording.recording import atomic_file
from ev_sim.running.output_folder import OutputFolder
from ev_sim.scenarios.scenario import Run

FILE = "content.json"
NEEDED = ("ev_sim", "ev_control", "ev_core", "ev_msgs_py", "numba", "llvmlite")  # what decides the bits


@dataclass(frozen=True)
class Content:
    """A run, and what of it the FMU is: the `law` of one role, or all but the roles in `without`."""

    run: Run
    law: str = ""
    without: Sequence[str] = ()

    def as_json(self) -> str:
        """All of it, and the versions that it was made with."""
        roles = {role: configuration.values() for role, configuration in self.run.configurations.items()}
        content = {"name": self.run.name, "duration": self.run.duration, "law": self.law, "without": [*self.without]}
        return json.dumps({**content, "versions": versions(), "roles": roles}, indent=1)


def versions() -> dict[str, str]:
    """The versions of what has to be installed where the FMU is run."""
    return {name: version(name) for name in NEEDED}


def read_content(folder: Path) -> Content:
    """What the file in a folder holds; RuntimeError if this machine has other versions than it was made with."""
    content: Mapping[str, Any] = json.loads((folder / FILE).read_text(encoding="utf-8"))
    here = versions()
    others = [f"{name} {made}, here {here[name]}" for name, made in content["versions"].items() if here[name] != made]
    if others:
        raise RuntimeError(f"this FMU was made with {'; '.join(others)}: its numbers would not be the same")
    configurations = {
        role: configure(role, values, MasterParameters if role == MASTER else None)
        for role, values in content["roles"].items()
    }
    run = Run(content["name"], "", configurations, content["duration"])
    return Content(run, content["law"], content["without"])


_MODULE = '''"""An FMU of ev_sim; all about it is in {file}."""

from ev_sim.fmu.slave import Slave


class {name}(Slave):
    """The model."""
'''


def write_fmu(content: Content, file: Path) -> None:
    """Write an FMU (FMI 2.0, co-simulation) whose model is named after the file, in the place of one of ours at most.

    ParameterError, in one line, for another name, unknown roles, a file of others there, and a law or a car that cannot
    be stepped on its own.
    """
    if file.suffix != ".fmu" or not re.fullmatch(r"[A-Za-z]\w*", file.stem):
        raise ParameterError(f"{file} is refused, allowed is NAME.fmu, where NAME is one of a variable in C")
    for role in (*content.without, *([content.law] if content.law else ())):
        if role not in content.run.configurations:
            raise unknown_name("role", role, content.run.configurations)
    known, path = set(sys.modules), list(sys.path)
    with OutputFolder(file.parent, f"fmu {file.name}", [file.name]), tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        module = folder / f"{file.stem}.py"
        module.write_text(_MODULE.format(file=FILE, name=file.stem), encoding="utf-8")
        (folder / FILE).write_text(content.as_json(), encoding="utf-8")
        try:
            built = FmuBuilder.build_FMU(module, folder / file.name, project_files=[folder / FILE])
        finally:
            sys.path[:] = path  # where the builder puts our folder
            if file.stem not in known:
                sys.modules.pop(file.stem, None)
        with atomic_file(file) as written:
            written.write(built.read_bytes())


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
        if content.law:
            configuration = content.run.configurations[content.law]
            law = SteppedLaw(configuration)
            self._period, inputs, outputs = configuration.period, law.inputs, law.outputs
            self._answer: Callable[[float, Mapping[str, float]], Mapping[str, float]] = law.answer
            self._shown: Mapping[str, float] = dict.fromkeys(outputs, 0.0)
        else:
            car = Simulation(content.run, content.without, record=False)
            read = {signal for role in car.kept for signal in content.run.configurations[role].method.reads}
            taken = {name for signal in read if signal in TOPICS for name in TOPICS[signal].channels}
            self._period, inputs = car.period, tuple(name for name in car.inputs if name in taken)
            self._answer, self._shown = lambda _time, given: car.step(given), car.frame
            outputs = tuple(name for name in self._shown if name not in car.inputs)
        self._given = dict.fromkeys(inputs, 0.0)
        self.default_experiment = DefaultExperiment(0.0, content.run.duration, stamps.to_seconds(self._period))
        self._declare(inputs, outputs)

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
            start, steps = stamps.from_seconds(current_time), stamps.from_seconds(step_size) / self._period
            if steps != int(steps) or steps < 1:
                allowed = f"{stamps.to_seconds(self._period):g} s or a multiple of it"
                raise ParameterError(f"step size {step_size:g} s is refused, allowed is {allowed}")
            for step in range(int(steps)):
                self._shown = self._answer(stamps.to_seconds(start + step * self._period), self._given)
        except ValueError as error:
            self.log(str(error), Fmi2Status.error)
            return False
        return True
