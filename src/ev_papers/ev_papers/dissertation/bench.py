"""Chapter 4 of the dissertation: the test bench."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_msgs_py.contract.optional_signals import BenchTemperatures
from ev_papers.dissertation.assumptions import IMPOSED, ROAD
from ev_papers.dissertation.measures.traction_windows import traction
from ev_papers.dissertation.runs import PART, parameter
from ev_papers.dissertation.studies.bench_cases import IDEAL, apart
from ev_sim.measures.samples import channel, run_named
from ev_sim.test_bench.sequence import SEQUENCE_STEPS, Sequence
from ev_sim.verdicts.check import Measure, Number, Tolerance, absolute, between
from ev_sim.verdicts.declaration import Declaration, judged, not_judgeable
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

_BENCH = ScenarioNeed("urban_mixed_bench", duration=24.0)
_EXACT_SENSORS = ScenarioNeed("urban_mixed_bench", IDEAL["sensors"], duration=24.0)
_ON_BENCH = ScenarioNeed("urban_mixed_bench", PART.values, duration=PART.duration)  # what PART is without a bench
_EXACT = absolute(1e-9, "exact")
_RPM = np.pi / 30.0
_WHEEL = "front_right"
_CLEAR = 5.0  # N m, torque difference above which a sign is no noise
_DEVICES = (
    "inverters with delays of 2 ms, rate limits and resolution, shaft of 20 kN m/rad, exchange every 5 ms, errors of "
    "the channels as twice the standard deviation of white noise: none of it is printed"
)


def _refused(sequence: Sequence, step: str) -> bool:
    try:
        sequence.after(step, cooling=True)
    except ValueError:
        return True
    return False


def _six_steps(*_driven: ScenarioRuns) -> float:
    """1 if the six steps lead back to the beginning and every other step is refused on the way."""
    sequence, in_order = Sequence(), True
    for due in SEQUENCE_STEPS:
        in_order = in_order and all(_refused(sequence, step) for step in SEQUENCE_STEPS if step != due)
        sequence = sequence.after(due, cooling=True)
    return float(in_order and sequence == Sequence())


def _error(sensor: str, whole: float) -> Measure:
    """Twice the noise of a sensor over its range [%]."""
    return lambda driven: 200.0 * parameter("test_bench", f"sensors.{sensor}.noise")(driven) / whole


def _channel(sensor: str, name: str, unit: str, whole: float, scale: float, error: Tolerance, percent: float) -> tuple:
    highest: Callable[[ScenarioRuns], float] = parameter("test_bench", f"sensors.{sensor}.highest")
    rounded = absolute(1e-3 * whole, "rounded")
    return (
        Number(unit, whole, rounded, lambda driven: highest(driven) / scale, f"range of {name}"),
        Number("%", percent, error, _error(sensor, whole * scale), f"error of {name}"),
    )


def _temperatures(driven: ScenarioRuns) -> float:
    """Of both circuits, with one rotor as in the source."""
    return float(len(driven.vehicle.driven_wheels) * (len(BenchTemperatures._fields) - 1) + 1)


def _torque_that_drives(driven: ScenarioRuns) -> float:
    """Torque of the virtual wheel over the one that the bench has measured with its rotor, while it drives [1]."""
    run = run_named(driven.runs, "urban_mixed_bench")
    motor, wheel = channel(run, f"motor_states.effort.{_WHEEL}"), channel(run, f"wheel_states.effort.{_WHEEL}")
    drives = motor > _CLEAR
    gear = driven.vehicle.gear_ratio * driven.vehicle.motor.gear_efficiency
    return float(wheel[drives].sum() / (gear * motor[drives].sum()))


def _speeds_apart(driven: ScenarioRuns) -> float:
    """Mean difference of the load machine's speed and of the virtual wheel's, over the largest [%]."""
    run = run_named(driven.runs, "urban_mixed_bench")
    wheel = driven.vehicle.gear_ratio * channel(run, f"wheel_states.velocity.{_WHEEL}")
    load = channel(run, f"bench.shafts.load_speed.{_WHEEL}")
    return float(100.0 * np.abs(load - wheel).mean() / np.abs(wheel).max())


def _spins_with_excess(driven: ScenarioRuns) -> float:
    """Share of the instants under torque at which the wheel gains speed where M_em exceeds M_nu, and loses it else."""
    run = run_named(driven.runs, "urban_mixed_bench")
    machine, load = channel(run, f"motor_states.effort.{_WHEEL}"), channel(run, f"bench.load_command.torque.{_WHEEL}")
    gained = np.diff(channel(run, f"wheel_states.velocity.{_WHEEL}"))[1:-1]
    excess = machine[2:-1] * driven.vehicle.motor.gear_efficiency - load[1:-2]
    clear = (np.abs(excess) > _CLEAR) & (machine[2:-1] > 0.0)
    return float((np.sign(gained[clear]) == np.sign(excess[clear])).mean())


def _difference(model: ScenarioRuns, bench: ScenarioRuns) -> float:
    """Mean difference of the right torque in traction over its largest value [%]."""
    run = run_named(model.runs, "urban_mixed")
    measured = channel(run_named(bench.runs, "urban_mixed_bench"), f"bench.shafts.torque.{_WHEEL}")
    return apart(measured, channel(run, f"motor_states.effort.{_WHEEL}"), traction(run, model.parameters["driver"]))


def _agreement(id: str) -> Declaration:
    return judged(
        id,
        (PART, _ON_BENCH),
        Number("%", 10.0, between(0.0, 10.0, "at most 5..10 %"), _difference, "method 1, mean"),
        assumption=f"mean difference over the largest torque; {_DEVICES}; {IMPOSED}; {ROAD}; of all methods in "
        "docs/test_bench.md",
    )


_ONE_PERCENT = between(1.0, 2.0, "1..2 % are printed; of the range, which is not said")

DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.bench.sequence",
        _BENCH,
        Number("1", 1.0, _EXACT, _six_steps),
        inputs="six services in this order; a step out of order is refused",
    ),
    judged(
        "diss.bench.channels",
        _BENCH,
        *_channel("bench_torque", "torque", "N m", 1000.0, 1.0, _EXACT, 0.1),
        *_channel("bench_speed", "speed", "rpm", 10000.0, _RPM, absolute(1e-4, "rounded"), 0.1),
        *_channel("bench_voltage", "voltage", "V", 750.0, 1.0, _EXACT, 0.1),
        *_channel("bench_current", "current", "A", 350.0, 1.0, _EXACT, 1.0),
        *_channel("bench_temperature", "temperatures", "degC", 200.0, 1.0, _ONE_PERCENT, 1.0),
        inputs="the sensors are given these ranges, and the errors, of the range, as two standard deviations",
    ),
    judged(
        "diss.bench.T1_T9",
        _BENCH,
        Number("1", 9.0, _EXACT, _temperatures),
        inputs="channels of bench/temperatures; the rotor is as warm as the winding, and each circuit shows its own",
    ),
    judged(
        "diss.bench.exchange",
        _BENCH,
        Number("1", 1.0, absolute(1e-2, "the wheel is shown the mean of the period"), _torque_that_drives, "torque"),
        Number("%", 0.0, between(0.0, 1.0, "delays of inverter and exchange"), _speeds_apart, "speeds apart"),
        assumption="the load machine is told the speed that the torques give the virtual wheel, and the wheel meets "
        "the road with the speed measured at the load machine",
    ),
    judged(
        "diss.bench.spin",
        _EXACT_SENSORS,
        Number("1", 1.0, between(0.95, 1.0, "one exchange between cause and effect"), _spins_with_excess),
        assumption="the sensors are exact: the page's errors hide small differences of the torques",
    ),
    _agreement("diss.bench.agreement"),
    _agreement("diss.fig5.26"),
    not_judgeable("diss.bench.timing", "neither sample time, model step, rate of the bus nor latency is printed"),
)
