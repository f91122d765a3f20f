"""Test bench of the dissertation (chapter 4), and the bench against the model (figure 5.26).

Each public function measures one number of published.csv, on recorded runs.
"""

from __future__ import annotations

import math

import numpy as np

from ev_bench.machines.sequence import SEQUENCE_STEPS, Sequence
from ev_msgs_py.contract.optional_signals import BenchTemperatures
from ev_papers.dissertation.measures.slip_curve import LITTLE_SLIP, MUCH_SLIP
from ev_papers.dissertation.measures.traction_windows import in_windows, traction
from ev_papers.dissertation.studies.bench_difference import apart
from ev_sim.surfaces import SURFACES
from ev_stack.measures.metric import channel, run_named, stretches
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns

_CLEAR = 5.0  # [N m], torque difference above which a sign is no noise
_SETTLED = 5.0  # [s], after which a load machine has settled
_UNITS = {"1": 1.0, "rpm": math.pi / 30.0}  # in SI
_RIGHT = "front_right"
_COMES_TO = 0.97  # share of a limit that counts as the limit [1]
_BEFORE = 0.05  # [s], within which a torque at its limit makes a wheel spin


def _bench(driven: ScenarioRuns) -> Recording:
    return run_named(driven.runs, "urban_mixed_bench")


def six_steps(driven: ScenarioRuns) -> float:
    """1 if the six steps lead back to the beginning and every other step is refused on the way."""
    sequence = Sequence()
    in_order = True
    for due in SEQUENCE_STEPS:
        others = (step for step in SEQUENCE_STEPS if step != due)
        in_order = in_order and all(_is_refused(sequence, step) for step in others)
        sequence = sequence.after(due, cooling=True)
    return float(in_order and sequence == Sequence())


def _is_refused(sequence: Sequence, step: str) -> bool:
    try:
        sequence.after(step, cooling=True)
    except ValueError:
        return True
    return False


def highest(driven: ScenarioRuns, sensor: str, unit: str = "1") -> float:
    """Range of a sensor of the bench, in a unit."""
    return float(driven.parameters["test_bench"][f"sensors.{sensor}.highest"]) / _UNITS[unit]


def error(driven: ScenarioRuns, sensor: str, whole: float, unit: str = "1") -> float:
    """Twice the noise of a sensor over a range in a unit [%]."""
    noise = float(driven.parameters["test_bench"][f"sensors.{sensor}.noise"])
    return 200.0 * noise / (whole * _UNITS[unit])


def temperatures(driven: ScenarioRuns) -> float:
    """Number of temperatures of both circuits, with one rotor as in the source [1]."""
    of_a_circuit = len(BenchTemperatures._fields) - 1
    return float(len(driven.vehicle.driven_wheels) * of_a_circuit + 1)


def torque_that_drives(driven: ScenarioRuns) -> float:
    """Torque of the virtual wheel over the measured one, with its rotor, while it drives [1]."""
    run = _bench(driven)
    motor = channel(run, f"motor_states.effort.{_RIGHT}")
    wheel = channel(run, f"wheel_states.effort.{_RIGHT}")
    drives = motor > _CLEAR
    gear = driven.vehicle.gear_ratio * driven.vehicle.motor.gear_efficiency
    return float(wheel[drives].sum() / (gear * motor[drives].sum()))


def spins_with_excess(driven: ScenarioRuns) -> float:
    """Share of the instants at which the wheel gains speed where M_em exceeds M_nu, else loses it.

    Counted are the instants under torque at which the excess is no noise [1].
    """
    run = _bench(driven)
    machine = channel(run, f"motor_states.effort.{_RIGHT}")
    load = channel(run, f"bench.load_command.torque.{_RIGHT}")
    # The load is that of the period before, and the speed answers in the period behind.
    gained = np.diff(channel(run, f"wheel_states.velocity.{_RIGHT}"))[1:-1]
    excess = machine[2:-1] * driven.vehicle.motor.gear_efficiency - load[1:-2]
    clear = (np.abs(excess) > _CLEAR) & (machine[2:-1] > 0.0)
    return float((np.sign(gained[clear]) == np.sign(excess[clear])).mean())


def _limit(driven: ScenarioRuns, wheel: str) -> np.ndarray:
    """Torque of a motor that the road can take, (phi_max + f_0 + f_surface) F_z r/(i eta), (n,)."""
    run = _bench(driven)
    vehicle = driven.vehicle
    friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")
    rolling = np.full(len(friction), vehicle.rolling_resistance)
    for surface in SURFACES.values():
        # The largest friction names the surface under the wheel.
        rolling[np.isclose(friction, surface.peak_friction)] += surface.rolling_resistance
    load = channel(run, f"tire_forces.load.{wheel}")
    gear = vehicle.gear_ratio * vehicle.motor.gear_efficiency
    return (friction + rolling) * load * vehicle.wheel_radius / gear


def within_the_limit(driven: ScenarioRuns, side: str) -> float:
    """Share of the instants under torque without much slip at which the road can take it [1]."""
    run = _bench(driven)
    wheel = f"front_{side}"
    torque = channel(run, f"motor_states.effort.{wheel}")
    slip = channel(run, f"tire_forces.slip_ratio.{wheel}")
    grips = (torque > _CLEAR) & (slip < LITTLE_SLIP)
    return float((torque <= _limit(driven, wheel))[grips].mean())


def onsets_at_the_limit(driven: ScenarioRuns) -> float:
    """Share of the onsets of much slip, of both wheels, just before which M_em was M_nu [1]."""
    run = _bench(driven)
    samples = round(_BEFORE / (run.time[1] - run.time[0]))
    at_limit = []
    for wheel in driven.vehicle.driven_wheels:
        slip = channel(run, f"tire_forces.slip_ratio.{wheel}")
        torque = channel(run, f"motor_states.effort.{wheel}")
        reaches = torque >= _COMES_TO * _limit(driven, wheel)
        for onset in np.flatnonzero((slip[1:] > MUCH_SLIP) & (slip[:-1] <= MUCH_SLIP)) + 1:
            at_limit.append(bool(reaches[max(onset - samples, 0) : onset + 1].any()))
    return sum(at_limit) / len(at_limit)


def circuits_apart(driven: ScenarioRuns) -> float:
    """Mean difference of the measured torques in traction, right and left, over the largest [%]."""
    run = _bench(driven)
    right = channel(run, f"bench.shafts.torque.{_RIGHT}")
    left = channel(run, "bench.shafts.torque.front_left")
    return apart(right, left, traction(run, driven.parameters["driver"]))


def difference(model: ScenarioRuns, bench: ScenarioRuns) -> float:
    """Mean difference of the right torque in traction over its largest value [%]."""
    run = run_named(model.runs, "urban_mixed")
    measured = channel(_bench(bench), f"bench.shafts.torque.{_RIGHT}")
    torque = channel(run, f"motor_states.effort.{_RIGHT}")
    return apart(measured, torque, traction(run, model.parameters["driver"]))


def windows_apart(model: ScenarioRuns, bench: ScenarioRuns) -> float:
    """Largest difference of the mean right torque of a window of traction, over the model's [%]."""
    run = run_named(model.runs, "urban_mixed")
    inside = in_windows(run, model.parameters["driver"])
    torque = channel(run, f"motor_states.effort.{_RIGHT}")
    measured = channel(_bench(bench), f"bench.shafts.torque.{_RIGHT}")
    found = 0.0
    for window in stretches(inside):
        found = max(found, abs(measured[window].mean() / torque[window].mean() - 1.0))
    return 100.0 * found


def difference_over(model: ScenarioRuns, bench: ScenarioRuns, exact: ScenarioRuns) -> float:
    """That difference on a bench with exact sensors over that on the bench [1]."""
    return difference(model, exact) / difference(model, bench)


def load_machine(driven: ScenarioRuns, run: str, quantity: str, side: str) -> float:
    """Value of a load machine that follows a constant, where it is furthest from its mean.

    The quantity is its torque [N m] or its speed [rad/s].
    """
    recording = run_named(driven.runs, run)
    values = channel(recording, f"bench.shafts.{quantity}.front_{side}")
    settled = values[recording.time >= _SETTLED]
    return float(settled[np.argmax(np.abs(settled - settled.mean()))])


def loops_with_flow(driven: ScenarioRuns) -> float:
    """Number of coolant loops with a measured flow [1]."""
    channels = run_named(driven.runs, "constant_speed").channels
    loops = [name for name in channels if name.startswith("bench.") and "flow" in name]
    return float(sum(channels[name][-1] > 0.0 for name in loops))
