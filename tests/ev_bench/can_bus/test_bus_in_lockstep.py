"""The bench behind its CAN bus as parts of the graph.

What the bus does to what passes, and what faults do.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import pairwise

import can
import numpy as np
import pytest
from can_bus.databases import by_cantools
from can_bus.exact_bits import exact_frame
from can_bus.lockstep_runs import HEALTHY, driven

import ev_stack
from ev_bench.bus.channel import bus_log
from ev_bench.bus.parameters import EV_BENCH
from ev_bench.runs.frame_log import FrameLog, logged_frames
from ev_core.parameters.data_file import find_file
from ev_msgs_py.refusal import ParameterError
from ev_papers.dissertation.studies import bench_faults
from ev_papers.dissertation.studies.bench_faults import FAULTS, trial
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.studies.study import drive_case

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def healthy():
    return driven(0.6)


def test_the_bus_is_loaded_and_late_as_the_analysis_says(healthy):
    """Below 60.6 % and 1.985 ms, the bounds of docs/can.md for frames of the greatest length."""
    for circuit in ("11", "12"):
        assert 0.45 < healthy[f"can.bus.load_{circuit}"][20:].mean() < 0.606
        assert 0.0005 < healthy[f"can.bus.latency_{circuit}"][20:].max() < 0.001985
        assert healthy[f"can.bus.lost_{circuit}"][-1] == 0.0


@pytest.fixture(scope="module")
def lossy():
    """A bus with traffic of others on which some frames are lost, and its run."""
    values = [*HEALTHY, ("test_bench", "bus.loss", 0.02), ("test_bench", "bus.other_load", 0.3)]
    (run,) = load_scenario("bench_fault", Overrides(values=values, duration=0.1)).runs
    return run, run_offline(run.configurations, run.duration)


@pytest.mark.parametrize("suffix", [".log", ".blf"])
def test_the_log_of_the_bus_is_read_by_other_tools(lossy, tmp_path, suffix):
    """100 cycles with two set-points and two motions on both channels, in the order of time."""
    run, recording = lossy
    file = tmp_path / f"bus{suffix}"
    assert FrameLog(bus_log(str(file)), run.configurations["test_bench"]).write(recording) == ""
    frames = list(can.LogReader(file))
    names = [by_cantools().get_message_by_frame_id(frame.arbitration_id).name for frame in frames]
    for kind in ("SetPoint", "Motion"):
        count = sum(name.endswith(f"_{kind}") for name in names)
        assert count == pytest.approx(4 * 100, abs=10)  # some are overtaken or still wait
    times = np.array([frame.timestamp for frame in frames]) - frames[0].timestamp
    assert np.all(np.diff(times) >= 0.0)
    assert times[-1] == pytest.approx(0.1, abs=0.001)


def test_the_log_is_the_modelled_bus(lossy):
    """Frames are as long as their bits and do not overlap.

    Load and counters are as modelled. Lost frames are on the wire, too: no counter of a set-point
    is missing.
    """
    run, recording = lossy
    frames, until = logged_frames(recording, run.configurations["test_bench"])
    assert until == recording.time[-1]
    assert recording.channels["can.bus.lost_11"][-1] > 10.0
    for circuit in ("11", "12"):
        own = [frame for frame in frames if frame.circuit == circuit]
        begins = [frame.time - 1e-6 * exact_frame(frame.identifier, frame.data) for frame in own]
        assert all(b > a.time - 1e-9 for a, b in zip(own[:-1], begins[1:], strict=True))
        # What is on the wire at the end counts as busy already; others send frames of 135 bits.
        busy = 1e-3 * recording.channels[f"can.bus.load_{circuit}"].sum()
        others = busy - sum(1e-6 * exact_frame(frame.identifier, frame.data) for frame in own)
        assert others / 135e-6 == pytest.approx(round(others / 135e-6), abs=1e-6)
        assert others == pytest.approx(0.3 * 0.1, abs=4 * 135e-6)  # from the second tick on
        counters = [
            frame.data[1] & 0xF for frame in own if frame.identifier == 0x20B + (circuit == "12")
        ]
        assert all((b - a) % 15 == 1 for a, b in pairwise(counters))


def test_the_log_ends_where_the_bench_was_another_one(lossy):
    run, recording = lossy
    channels = {
        **recording.channels,
        "can.bus.load_11": recording.channels["can.bus.load_11"].copy(),
    }
    channels["can.bus.load_11"][40] += 0.001
    bench = run.configurations["test_bench"]
    assert logged_frames(Recording(recording.time, channels), bench)[1] == recording.time[39]


def test_the_load_of_others_makes_frames_late(healthy):
    loaded = driven(0.6, ("test_bench", "bus.other_load", 0.3))
    assert loaded["can.bus.latency_11"].max() > healthy["can.bus.latency_11"].max() + 0.0001


@pytest.mark.parametrize("load", [0.3, 0.405])
def test_set_points_that_come_after_the_inverters_phase_act_a_cycle_later(healthy, load):
    """Set-points that meet the next one on the wire, at a load of 40.5 %, still act."""
    loaded = driven(0.6, ("test_bench", "bus.other_load", load))
    for side in ("left", "right"):
        channel = f"bench.shafts.set_point.front_{side}"
        assert loaded[channel][500:] == pytest.approx(healthy[channel][500:], abs=0.1)


def test_single_lost_frames_leave_the_last_value_and_no_fault():
    """2 % lost by seed: what was valid last is held, and no time-out is reached."""
    lossy = driven(0.6, ("test_bench", "bus.loss", 0.02), ("test_bench", "bus.seed", 3))
    assert lossy["can.bus.lost_11"][-1] > 5.0
    assert np.all(lossy["bench.shafts.set_point.front_right"][400:] > 30.0)
    again = driven(0.6, ("test_bench", "bus.loss", 0.02), ("test_bench", "bus.seed", 3))
    assert all(again[name].tobytes() == values.tobytes() for name, values in lossy.items())


@pytest.fixture(scope="module")
def faulty():
    """Torques that grow, noise, lost frames, and a trip within half a second.

    The same driven offline.
    """
    values = [("test_bench", "bus.loss", 0.02), ("test_bench", "sensors.bench_torque.noise", 0.5)]
    values += [("test_bench", "inject.begin", 0.4), ("inverter_gateway", "reset_at", 0.45)]
    (run,) = load_scenario("bench_fault", Overrides(values=values, duration=0.5)).runs
    return run, run_offline(run.configurations, run.duration)


@pytest.mark.parametrize(
    "way", [run_in_process, pytest.param(run_in_processes, marks=pytest.mark.weekly)]
)
def test_bench_and_bus_give_the_same_bits_in_all_ways_of_running(faulty, way, tmp_path):
    run, offline = faulty
    assert offline.channels["can.bus.lost_11"][-1] > 5.0
    assert offline.channels["bench.shafts.set_point.front_right"].any()
    outcome = way(run, tmp_path, False, lambda time: None)
    assert signal_hash(outcome.recording) == signal_hash(offline)


def test_without_the_operators_enabling_nothing_is_switched_on():
    """Steps of the test sequence are the parameter `enabled`.

    Here for the left circuit, which works alone.
    """
    left = driven(0.4, ("test_bench", "enabled", "left"))
    for part in ("machine", "load"):
        for side, works in (("right", False), ("left", True)):
            assert left[f"bench.shafts.{part}_torque.front_{side}"].any() == works


@pytest.mark.parametrize(("rate", "waits"), [(125e3, True), (1e6, False)])
def test_a_run_without_enabled_drives_has_a_note(rate, waits):
    """A bus that is too slow brings no feedback: nothing is latched, and the car has no torque."""
    values = {f"{role}.{name}": value for role, name, value in HEALTHY}
    run = ev_stack.run("bench_fault", set={**values, "test_bench.bus.bit_rate": rate})
    (outcome,) = run.outcomes.values()
    torque = outcome.recording.channels["bench.shafts.machine_torque.front_left"]
    assert torque.any() == (not waits)
    note = "/ev/inverter_gateway: the drives waited for more than 2 s to be enabled"
    assert outcome.notes == ((note,) if waits else ())


def test_both_ends_of_the_bus_have_one_database(tmp_path):
    """Frames of twice the step at one end would give half the torque."""
    other = tmp_path / "coarse.dbc"
    fine = " SG_ Torque : 24|16@1- (0.03125,0)"
    text = find_file(EV_BENCH).read_text(encoding="utf-8")
    assert fine in text
    other.write_text(text.replace(fine, fine.replace("0.03125", "0.0625")), encoding="utf-8")
    of_bench = ("test_bench", "bus.database", str(other))
    of_gateway = ("inverter_gateway", "bus.database", str(other))
    with pytest.raises(ParameterError, match="requires inverter_gateway"):
        driven(0.1, of_gateway)
    for values in ((of_bench,), (of_bench, of_gateway)):
        run = driven(0.6, *values)
        asked = run["torque_command.drive.front_left"][-1] / 7.4
        given = run["bench.shafts.machine_torque.front_left"][-1]
        assert given == pytest.approx(asked, abs=0.04) and asked > 10.0


def test_a_wheel_that_grips_again_is_no_fault():
    """A rotor slows down by 2000 rad/s^2 in the urban cycle: that is no wrong transducer."""
    values = [("test_bench", "method", "circuits_on_can")]
    (run,) = load_scenario("urban_mixed_bench", Overrides(values=values, duration=33.0)).runs
    noted: list[str] = []
    channels = run_offline(
        run.configurations, run.duration, note=lambda _, text: noted.append(text)
    ).channels
    speed = channels["bench.shafts.speed.front_right"]
    assert np.diff(speed).min() < -0.005 * 1500.0
    assert noted == []


@pytest.mark.parametrize("what", FAULTS)
def test_a_fault_in_the_loop_ends_the_torque_in_time_and_is_latched_by_name(what):
    """One seed; the study `bench_faults` drives a hundred."""
    result = drive_case(trial(what, 1), bench_faults.measure)
    assert not bench_faults.wrong(what, result)


def test_the_load_machine_is_held_against_the_gear_ratio_that_is_driven():
    """The scenario's car has 7.4; with it the fault would seem to begin before its time."""
    what = "load machine at its limit"
    case = trial(what, 1)
    other_gear = (
        *case.values,
        ("*", "vehicle.gear_ratio", 8.0),
        ("inverter_gateway", "gear_ratio", 8.0),
    )
    assert not bench_faults.wrong(
        what, drive_case(replace(case, values=other_gear), bench_faults.measure)
    )


def test_a_trial_without_a_fault_fails():
    """Trials show something only if one without a fault fails."""
    case = trial("inverter trip", 1)
    healthy = (*case.values[0][:2], "none")
    result = drive_case(case.__class__(case.name, case.scenario, (healthy, *case.values[1:]), duration=case.duration),
                        bench_faults.measure)  # fmt: skip
    assert "not named on the bus" in bench_faults.wrong("inverter trip", result)


def test_a_control_period_that_is_no_number_of_cycles_is_refused():
    with pytest.raises(
        ParameterError, match=r"expected on a CAN bus are 1 to 5 cycles of 0\.001 s"
    ):
        driven(0.1, ("*", "control_period", 0.0025))


def test_seeds_must_be_there():
    with pytest.raises(ParameterError, match="--seeds: 0 is refused"):
        bench_faults.cases(argparse.Namespace(seeds=0))
