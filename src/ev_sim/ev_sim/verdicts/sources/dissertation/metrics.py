"""Eqs 2.37 to 2.40 of the dissertation, on a recorded run."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_msgs_py.vehicle.drive_train import wheel_inertia
from ev_sim.drives.losses import loss_power
from ev_sim.report.quantities.circuit_sums import CircuitSums
from ev_sim.report.quantities.circuits import circuits
from ev_sim.report.quantities.traction_windows import traction
from ev_sim.report.samples import channel, run_named
from ev_sim.verdicts.check import Number
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.sources.dissertation.runs import PART
from ev_sim.verdicts.tolerance import absolute

_ROUNDING = absolute(1e-12, "the same sums in another order, over 95 s")
_CYCLE_TIME = 580.0  # [s]
_WHEEL = "front_left"


class _Samples:
    """What the equations sum, of the samples in traction, (n,) each."""

    def __init__(self, driven: ScenarioRuns) -> None:
        run, car = run_named(driven.runs, "urban_mixed"), driven.vehicle
        self.inside = traction(run, driven.parameters["driver"])
        speed = channel(run, f"wheel_states.velocity.{_WHEEL}")
        period = np.diff(run.time, prepend=run.time[0] - 1.0)
        force = channel(run, f"tire_forces.longitudinal_force.{_WHEEL}")[self.inside]
        gained = wheel_inertia(car, _WHEEL) * (np.diff(speed, prepend=speed[0]) / period)[self.inside]
        self.torque = channel(run, f"wheel_states.effort.{_WHEEL}")[self.inside]  # M_k [N m]
        self.resistance = self.torque - car.wheel_radius * force - gained  # M_f [N m]
        self.speed = speed[self.inside]  # w_k [rad/s]
        self.free = channel(run, "wheel_states.velocity.rear_left")[self.inside]  # w_free [rad/s]
        motor, shaft = (channel(run, f"motor_states.{of}.{_WHEEL}")[self.inside] for of in ("effort", "velocity"))
        self.mechanical = motor * shaft  # [W]
        self.electrical = self.mechanical + loss_power(car.motor, motor, shaft)  # U I [W]
        self.reported = circuits(run, car, self.inside)[_WHEEL]

    @property
    def wheel(self) -> float:
        """Eq 2.37 [1]."""
        force = (self.torque.sum() - self.resistance.sum()) / self.torque.sum()
        return float(force * self.free.sum() / self.speed.sum())

    @property
    def drive(self) -> float:
        """Eq 2.38 [1]."""
        return float(self.mechanical.sum() / self.electrical.sum())

    @property
    def energy(self) -> float:
        """Eq 2.40 of one circuit [W s]."""
        return float(self.electrical.sum() * _CYCLE_TIME / len(self.electrical))


def _formula(id: str, printed: Callable[[_Samples], float], reported: Callable[[CircuitSums], float]) -> Declaration:
    def difference(driven: ScenarioRuns) -> float:
        samples = _Samples(driven)
        return reported(samples.reported) / printed(samples) - 1.0

    return judged(
        id,
        PART,
        Number("1", 0.0, _ROUNDING, difference, "relative difference"),
        assumption="M_f is rolling resistance (2.1.1); U I is the power at the shaft and the losses of the machine",
    )


DECLARATIONS: tuple[Declaration, ...] = (
    _formula("diss.eq2.37", lambda at: at.wheel, lambda circuit: circuit.efficiency),
    _formula("diss.eq2.38", lambda at: at.drive, lambda circuit: circuit.drive_efficiency),
    _formula("diss.eq2.39", lambda at: at.wheel * at.drive, lambda circuit: circuit.total_efficiency),
    _formula("diss.eq2.40", lambda at: at.energy, lambda circuit: circuit.energy(_CYCLE_TIME)),
)
