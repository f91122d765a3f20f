"""The urban cycle on the bench, and what it shares with the virtual run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.refusal import ParameterError
from ev_papers.dissertation.studies.bench_convergence import case as part_of_cycle
from ev_papers.dissertation.studies.bench_difference import IDEAL, apart, ideal, measure
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.studies.study import drive_case

LENGTH = 24.0  # s: rest, pulling away, two surfaces, spinning wheels


@pytest.fixture(scope="module")
def recording():
    """A run with exact sensors."""
    (run,) = load_scenario(
        "urban_mixed_bench", Overrides(values=IDEAL["sensors"], duration=LENGTH)
    ).runs
    return run_offline(run.configurations, LENGTH)


def test_the_energy_of_the_bench_balances(recording):
    """Battery + mains = resistor + heat + stored; the car's battery gave the machines' part.

    The battery follows one exchange later, by voltage and current in single precision: 0.1 %.
    """
    last = {
        name: recording.channels[f"bench.energy.{name}"][-1]
        for name in ("battery", "mains", "resistor", "machines")
    }
    last |= {
        name: recording.channels[f"bench.energy.{name}"][-1]
        for name in ("loads", "shafts", "stored")
    }
    gone = last["resistor"] + last["machines"] + last["loads"] + last["shafts"] + last["stored"]
    assert last["battery"] + last["mains"] == pytest.approx(gone, rel=1e-9)
    given = -recording.channels["battery.voltage"] * recording.channels["battery.current"]
    assert given.sum() * 0.005 == pytest.approx(last["battery"], rel=1e-3)


def test_the_virtual_wheel_spins_up_when_the_machine_exceeds_the_load(recording):
    """diss.bench.spin.

    The sign of the wheel's acceleration is that of M_em - M_nu, one exchange later.
    """
    channels = recording.channels
    speed = channels["wheel_states.velocity.front_left"]
    machine, load = (
        channels["motor_states.effort.front_left"],
        channels["bench.load_command.torque.front_left"],
    )
    gained = np.diff(speed)[1:-1]
    excess = machine[2:-1] * 0.97 - load[1:-2]  # behind the gear
    clear = (np.abs(excess) > 5.0) & (machine[2:-1] > 0.0)
    assert clear.sum() > 200
    assert (np.sign(gained[clear]) == np.sign(excess[clear])).mean() > 0.95


def test_a_bench_needs_its_plant():
    with pytest.raises(
        ParameterError, match="reads LoadCommand, which none of the chosen methods writes"
    ):
        load_scenario("urban_mixed_bench", Overrides(values=[("plant", "method", "planar")]))
    with pytest.raises(
        ParameterError, match="reads BenchShafts, which none of the chosen methods writes"
    ):
        load_scenario("urban_mixed", Overrides(values=[("plant", "method", "planar_on_bench")]))


def test_without_a_bench_the_graph_is_as_short_as_ever():
    """A scenario without a bench has no node, no channel and no number of it in the frames."""
    (run,) = load_scenario("urban_mixed", Overrides(duration=0.05)).runs
    assert tuple(run.configurations) == REQUIRED
    assert not [
        name for name in run_offline(run.configurations, 0.05).channels if name.startswith("bench")
    ]


@pytest.mark.slow
def test_an_ideal_bench_converges_to_the_virtual_run():
    """Difference of the torque over its largest value.

    Below 0.1 %, and with a shorter exchange it gets smaller.
    """
    apart_by_period = {}
    for period in (2e-3, 5e-4):
        values = (("*", "control_period", period),)
        virtual = drive_case(
            part_of_cycle("imposed_speed", "virtual", "urban_mixed", values), measure
        ).measured
        of_bench = (*ideal(), *values)
        bench = drive_case(
            part_of_cycle("imposed_speed", "bench", "urban_mixed_bench", of_bench), measure
        ).measured
        apart_by_period[period] = apart(bench["torque"], virtual["torque"])
    assert apart_by_period[5e-4] < 0.1
    assert apart_by_period[5e-4] < apart_by_period[2e-3]


def test_samples_stand_at_the_instants_at_which_they_were_taken():
    """2 ms do not divide 5 ms.

    Every second sample is taken, which was drawn as if they lay 5 ms apart.
    """
    case = part_of_cycle("pulse", "coarse", "urban_mixed", (("*", "control_period", 2e-3),))
    measured = drive_case(replace(case, duration=16.5), measure).measured
    assert np.diff(measured["instants"]) == pytest.approx(0.004, rel=1e-9)
    assert len(measured["instants"]) == len(measured["torque"]) == len(measured["pressed"])
