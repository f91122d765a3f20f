"""Cycle, traction control and test bench of the dissertation (chapters 2 and 4) as they are judged on recorded runs.

Each public function measures one number of published.csv.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_bench.machines.sequence import SEQUENCE_STEPS, Sequence
from ev_core.parameters.data_file import find_file
from ev_core.vehicle.driveline import wheel_inertia
from ev_core.vehicle.losses import loss_power
from ev_msgs_py.contract.optional_signals import BenchTemperatures
from ev_papers.dissertation.measures.circuits import CircuitSums, circuits
from ev_papers.dissertation.measures.slip_curve import (
    LARGEST_ERROR,
    SlipCurve,
    first_passed_peak,
    slip_and_road_torque,
)
from ev_papers.dissertation.measures.traction_windows import traction
from ev_papers.dissertation.studies.bench_difference import apart
from ev_stack.measures.metric import channel, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns

_KILOMETRE_PER_HOUR = 1 / 3.6  # [m/s]
_CYCLE_TIME = 580.0  # [s]
_CLEAR = 5.0  # N m, torque difference above which a sign is no noise
_GRIPS = 0.05  # [1], slip below that of the peak on every road of the cycle
_UNITS = {"rpm": np.pi / 30.0}  # [rad/s]


_LEFT, _RIGHT = "front_left", "front_right"


def _model(driven: ScenarioRuns) -> Recording:
    return run_named(driven.runs, "urban_mixed")


def _bench(driven: ScenarioRuns) -> Recording:
    return run_named(driven.runs, "urban_mixed_bench")


def _points(driven: ScenarioRuns) -> np.ndarray:
    """Time [s] and speed [m/s] of the driver's profile, (n, 2)."""
    driver = driven.parameters["driver"]
    return np.column_stack((driver["speed_profile.time"], driver["speed_profile.speed"]))


def points(driven: ScenarioRuns) -> float:
    """How many points the driver's profile has."""
    return float(len(_points(driven)))


def beyond_the_table(driven: ScenarioRuns) -> float:
    """Largest difference of the profile from table 2.4 at the points of both [m/s]."""
    table = np.loadtxt(find_file("cycles/trrl_1_1.csv"), delimiter=",", skiprows=1)
    points = _points(driven)
    times = np.union1d(points[:, 0], table[:, 0])
    printed = np.interp(times, table[:, 0], table[:, 1] * _KILOMETRE_PER_HOUR)
    return float(np.abs(np.interp(times, points[:, 0], points[:, 1]) - printed).max())


def length(driven: ScenarioRuns) -> float:
    """Length of the driver's profile [m]."""
    points = _points(driven)
    return float((np.diff(points[:, 0]) * (points[1:, 1] + points[:-1, 1]) / 2).sum())


def duration(driven: ScenarioRuns) -> float:
    """Duration of the driver's profile [s]."""
    return float(_points(driven)[-1, 0])


def mean_speed(driven: ScenarioRuns) -> float:
    """Mean speed of the driver's profile [km/h]."""
    return length(driven) / duration(driven) / _KILOMETRE_PER_HOUR


def windows(driven: ScenarioRuns) -> float:
    """How many windows the driver is given."""
    return float(len(driven.parameters["driver"]["modes.begin"]))


def time_of(driven: ScenarioRuns, mode: str) -> float:
    """How long the windows of a mode last [s]."""
    driver = driven.parameters["driver"]
    begin = [*driver["modes.begin"], _CYCLE_TIME]
    return float(np.diff(begin)[[each == mode for each in driver["modes.mode"]]].sum())


class _Samples:
    """What the equations sum, of the samples in traction, (n,) each."""

    def __init__(self, driven: ScenarioRuns) -> None:
        run, car = _model(driven), driven.vehicle
        self.inside = traction(run, driven.parameters["driver"])
        speed = channel(run, f"wheel_states.velocity.{_LEFT}")
        period = np.diff(run.time, prepend=run.time[0] - 1.0)
        force = channel(run, f"tire_forces.longitudinal_force.{_LEFT}")[self.inside]
        gained = (
            wheel_inertia(car, _LEFT) * (np.diff(speed, prepend=speed[0]) / period)[self.inside]
        )
        self.torque = channel(run, f"wheel_states.effort.{_LEFT}")[self.inside]  # M_k [N m]
        self.resistance = self.torque - car.wheel_radius * force - gained  # M_f [N m]
        self.speed = speed[self.inside]  # w_k [rad/s]
        self.free = channel(run, "wheel_states.velocity.rear_left")[self.inside]  # w_free [rad/s]
        motor, shaft = (
            channel(run, f"motor_states.{of}.{_LEFT}")[self.inside] for of in ("effort", "velocity")
        )
        self.mechanical = motor * shaft  # [W]
        self.electrical = self.mechanical + loss_power(car.motor, motor, shaft)  # U I [W]
        self.reported = circuits(run, car, self.inside)[_LEFT]

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


_FORMULAS: dict[str, tuple[Callable[[_Samples], float], Callable[[CircuitSums], float]]] = {
    "wheel": (lambda at: at.wheel, lambda circuit: circuit.efficiency),
    "drive": (lambda at: at.drive, lambda circuit: circuit.drive_efficiency),
    "total": (lambda at: at.wheel * at.drive, lambda circuit: circuit.total_efficiency),
    "energy": (lambda at: at.energy, lambda circuit: circuit.energy(_CYCLE_TIME)),
}


def beyond_the_formula(driven: ScenarioRuns, name: str) -> float:
    """Relative difference of what the report has of an efficiency or energy from eqs 2.37 to 2.40 as printed [1]."""
    printed, reported = _FORMULAS[name]
    samples = _Samples(driven)
    return reported(samples.reported) / printed(samples) - 1.0


def largest_error() -> float:
    """Largest F of a fit that counts [1]."""
    return LARGEST_ERROR


def _fit(driven: ScenarioRuns) -> SlipCurve:
    """The fit where the left wheel first passes its peak."""
    return first_passed_peak(_model(driven), driven.vehicle, _LEFT)


def beyond_the_zero_of_the_slope(driven: ScenarioRuns) -> float:
    """Distance of (B/(2 A))^2 from where A + B/(2 sqrt(x)) changes its sign, found by halving [1]."""
    curve = _fit(driven)
    if not curve.a < 0.0 < curve.b:
        return math.inf
    low, high = 1e-12, 1.0
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (
            (middle, high) if curve.a + curve.b / (2 * math.sqrt(middle)) > 0.0 else (low, middle)
        )
    return abs(curve.peak - low)


def rises_then_falls(driven: ScenarioRuns) -> bool:
    """Whether the fitted curve rises to its peak, and the samples go beyond it, where it falls."""
    run, curve = _model(driven), _fit(driven)
    x = slip_and_road_torque(run, driven.vehicle, _LEFT)[0][curve.window]
    at = curve.at
    return bool(x[0] < curve.peak < x[-1] and at(x[0]) < at(curve.peak) > at(x[-1]))


def _refused(sequence: Sequence, step: str) -> bool:
    try:
        sequence.after(step, cooling=True)
    except ValueError:
        return True
    return False


def six_steps(driven: ScenarioRuns) -> float:
    """1 if the six steps lead back to the beginning and every other step is refused on the way."""
    sequence, in_order = Sequence(), True
    for due in SEQUENCE_STEPS:
        in_order = in_order and all(
            _refused(sequence, step) for step in SEQUENCE_STEPS if step != due
        )
        sequence = sequence.after(due, cooling=True)
    return float(in_order and sequence == Sequence())


def highest(driven: ScenarioRuns, sensor: str, unit: str = "1") -> float:
    """The range of a sensor of the bench, in a unit."""
    return float(driven.parameters["test_bench"][f"sensors.{sensor}.highest"]) / _UNITS.get(
        unit, 1.0
    )


def error(driven: ScenarioRuns, sensor: str, whole: float, unit: str = "1") -> float:
    """Twice the noise of a sensor over a range in a unit [%]."""
    noise = float(driven.parameters["test_bench"][f"sensors.{sensor}.noise"])
    return 200.0 * noise / (whole * _UNITS.get(unit, 1.0))


def temperatures(driven: ScenarioRuns) -> float:
    """Of both circuits, with one rotor as in the source."""
    return float(len(driven.vehicle.driven_wheels) * (len(BenchTemperatures._fields) - 1) + 1)


def torque_that_drives(driven: ScenarioRuns) -> float:
    """Torque of the virtual wheel over the one that the bench has measured with its rotor, while it drives [1]."""
    run = _bench(driven)
    motor, wheel = (
        channel(run, f"motor_states.effort.{_RIGHT}"),
        channel(run, f"wheel_states.effort.{_RIGHT}"),
    )
    drives = motor > _CLEAR
    gear = driven.vehicle.gear_ratio * driven.vehicle.motor.gear_efficiency
    return float(wheel[drives].sum() / (gear * motor[drives].sum()))


def spins_with_excess(driven: ScenarioRuns) -> float:
    """Share of the instants under torque at which the wheel gains speed where M_em exceeds M_nu, and loses it else."""
    run = _bench(driven)
    machine, load = (
        channel(run, f"motor_states.effort.{_RIGHT}"),
        channel(run, f"bench.load_command.torque.{_RIGHT}"),
    )
    gained = np.diff(channel(run, f"wheel_states.velocity.{_RIGHT}"))[1:-1]
    excess = machine[2:-1] * driven.vehicle.motor.gear_efficiency - load[1:-2]
    clear = (np.abs(excess) > _CLEAR) & (machine[2:-1] > 0.0)
    return float((np.sign(gained[clear]) == np.sign(excess[clear])).mean())


def circuits_apart(driven: ScenarioRuns) -> float:
    """Mean difference of the measured torques right and left in traction over the largest one [%]."""
    run = _bench(driven)
    right, left = (channel(run, f"bench.shafts.torque.{wheel}") for wheel in (_RIGHT, _LEFT))
    return apart(right, left, traction(run, driven.parameters["driver"]))


def difference(model: ScenarioRuns, bench: ScenarioRuns) -> float:
    """Mean difference of the right torque in traction over its largest value [%]."""
    run = _model(model)
    measured = channel(_bench(bench), f"bench.shafts.torque.{_RIGHT}")
    return apart(
        measured,
        channel(run, f"motor_states.effort.{_RIGHT}"),
        traction(run, model.parameters["driver"]),
    )


def difference_over(model: ScenarioRuns, bench: ScenarioRuns, exact: ScenarioRuns) -> float:
    """That difference on a bench with exact sensors over that on the bench [1]."""
    return difference(model, exact) / difference(model, bench)


_SETTLED = 5.0  # s, after which a launch and a load machine have settled


def _at_the_end(run: Recording, name: str) -> np.ndarray:
    return channel(run, name)[run.time >= _SETTLED]


def load_machine(driven: ScenarioRuns, run: str, quantity: str, side: str) -> float:
    """Torque [N m] or speed [rad/s] of a load machine that follows a constant: where it is furthest from its mean."""
    values = _at_the_end(run_named(driven.runs, run), f"bench.shafts.{quantity}.front_{side}")
    return float(values[np.argmax(np.abs(values - values.mean()))])


def loops_with_flow(driven: ScenarioRuns) -> float:
    """Coolant loops whose flow is measured [1]."""
    run = run_named(driven.runs, "constant_speed")
    return float(
        sum(
            name.startswith("bench.coolant.") and run.channels[name][-1] > 0.0
            for name in run.channels
        )
    )
