"""Couple FMUs of a car and of a law by FMPy, keep what both show: python couple_fmus.py CAR LAW SECONDS OUT.npz.

The FMUs are those of

    ev-stack fmu shchur2019 --without electronic_differential --out car.fmu
    ev-stack fmu shchur2019 --only electronic_differential --out law.fmu
"""

import sys
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave


class Unit:
    """One FMU, unpacked in a folder: numbers by name."""

    def __init__(self, file: str, folder: str) -> None:
        described = fmpy.read_model_description(file)
        self.step = float(described.defaultExperiment.stepSize)
        self.slave = FMU2Slave(
            guid=described.guid,
            unzipDirectory=fmpy.extract(file, folder),
            modelIdentifier=described.coSimulation.modelIdentifier,
            instanceName=described.modelName,
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.inputs, self.outputs = (
            {v.name: v.valueReference for v in described.modelVariables if v.causality == causality}
            for causality in ("input", "output")
        )

    def do_step(self, time: float, given: dict[str, float]) -> None:
        """One step from a time on [s], with these inputs."""
        self.slave.setReal(list(self.inputs.values()), [given[name] for name in self.inputs])
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=self.step)

    @property
    def shown(self) -> dict[str, float]:
        """All outputs."""
        return dict(zip(self.outputs, self.slave.getReal(list(self.outputs.values())), strict=True))


def main(car: Unit, law: Unit, seconds: str, out: str) -> None:
    """The law first, then the car with its answer."""
    rows = []
    for n in range(round(float(seconds) / car.step) + 1):
        time, shown = n * car.step, car.shown
        law.do_step(time, shown)
        answer = law.shown
        car.do_step(time, answer)
        rows.append({"time": time, **shown, **answer})
    np.savez(out, **{name: [row[name] for row in rows] for name in rows[0]})
    print(f"{len(rows)} steps, speed {rows[-1]['twist.longitudinal']:.3f} m/s")


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    car_file, law_file, *how = sys.argv[1:]
    with TemporaryDirectory() as of_car, TemporaryDirectory() as of_law:
        main(Unit(car_file, of_car), Unit(law_file, of_law), *how)
