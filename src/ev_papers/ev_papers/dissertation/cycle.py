"""The cycle of the dissertation: table 2.4, its windows and its length, and eqs 2.37 to 2.40 on a recorded run."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.parameters.data_file import find_file
from ev_core.vehicle.drive_train import wheel_inertia
from ev_papers.dissertation.measures.circuits import CircuitSums, circuits
from ev_papers.dissertation.measures.traction_windows import traction
from ev_papers.dissertation.runs import MODEL, PART
from ev_sim.drives.electrical_side import loss_power
from ev_sim.measures.samples import channel, run_named
from ev_sim.verdicts.check import Number, absolute, relative
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns

_GIVEN = "the driver is given table 2.4 (config/cycles/trrl_1_1.csv)"
_EXACT = relative(0.0, "exact")
_END = 580.0  # [s]
_KILOMETRE_PER_HOUR = 1 / 3.6  # [m/s]


def _points(driven: ScenarioRuns) -> np.ndarray:
    """Time [s] and speed [m/s] of the driver's profile, (n, 2)."""
    driver = driven.parameters["driver"]
    return np.column_stack((driver["speed_profile.time"], driver["speed_profile.speed"]))


def _beyond_the_table(driven: ScenarioRuns) -> float:
    """Largest difference of the profile from table 2.4 at the points of both [m/s]."""
    table = np.loadtxt(find_file("cycles/trrl_1_1.csv"), delimiter=",", skiprows=1)
    points = _points(driven)
    times = np.union1d(points[:, 0], table[:, 0])
    printed = np.interp(times, table[:, 0], table[:, 1] * _KILOMETRE_PER_HOUR)
    return float(np.abs(np.interp(times, points[:, 0], points[:, 1]) - printed).max())


def _length(driven: ScenarioRuns) -> float:
    points = _points(driven)
    return float((np.diff(points[:, 0]) * (points[1:, 1] + points[:-1, 1]) / 2).sum())


def _time_of(mode: str) -> Callable[[ScenarioRuns], float]:
    """How long the windows of a mode last [s]."""

    def measure(driven: ScenarioRuns) -> float:
        driver = driven.parameters["driver"]
        begin = [*driver["modes.begin"], _END]
        return float(np.diff(begin)[[each == mode for each in driver["modes.mode"]]].sum())

    return measure


_SECONDS = absolute(0.05, "one digit")

_CYCLE_DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.t2.4",
        MODEL,
        Number("1", 90.0, _EXACT, lambda driven: float(len(_points(driven))), "points"),
        Number("m/s", 0.0, absolute(1e-12, "exact, but for the unit"), _beyond_the_table, "largest difference"),
        inputs=_GIVEN,
    ),
    judged(
        "diss.fig2.12",
        MODEL,
        Number("m/s", 0.0, absolute(1e-12, "exact, but for the unit"), _beyond_the_table, "difference from table 2.4"),
        inputs=_GIVEN,
    ),
    judged(
        "diss.modes",
        MODEL,
        Number("1", 19.0, _EXACT, lambda driven: float(len(driven.parameters["driver"]["modes.begin"])), "windows"),
        Number("s", 355.2, _SECONDS, _time_of("traction"), "traction"),
        Number("s", 143.6, _SECONDS, _time_of("regen"), "regeneration"),
        Number("s", 81.2, _SECONDS, _time_of("stop"), "stop"),
        inputs="the driver is given the windows",
    ),
    judged(
        "diss.cycle.length",
        MODEL,
        Number("m", 4402.6, absolute(0.1, "one digit"), _length, "length"),
        Number("s", 580.0, _EXACT, lambda driven: float(_points(driven)[-1, 0]), "duration"),
        inputs=_GIVEN,
    ),
)


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


_METRICS_DECLARATIONS: tuple[Declaration, ...] = (
    _formula("diss.eq2.37", lambda at: at.wheel, lambda circuit: circuit.efficiency),
    _formula("diss.eq2.38", lambda at: at.drive, lambda circuit: circuit.drive_efficiency),
    _formula("diss.eq2.39", lambda at: at.wheel * at.drive, lambda circuit: circuit.total_efficiency),
    _formula("diss.eq2.40", lambda at: at.energy, lambda circuit: circuit.energy(_CYCLE_TIME)),
)


DECLARATIONS = (*_CYCLE_DECLARATIONS, *_METRICS_DECLARATIONS)
