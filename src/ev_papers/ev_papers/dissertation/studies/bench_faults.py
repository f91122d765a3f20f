"""Every fault of the bench and its bus, seeded, in the loop: time to zero torque, and the way back.

A trial injects a fault at a random instant, side and torque. The cause ends, the drives are enabled
in vain, and a reset brings them back; meanwhile torque, bus and notes show what was done.
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ev_bench.bus.parameters import load_database
from ev_msgs_py.can.payload import joined
from ev_msgs_py.refusal import ParameterError
from ev_stack.measures.metric import Metric, metric
from ev_stack.recording.recording import Recording
from ev_stack.report.tables import text_table
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, CaseResult, Results

ABOUT = (
    "Faults of bus, inverters and bench in the loop: "
    "zero torque in time, latched, named, reset (--seeds N)"
)
SCENARIO = "bench_fault"
SEEDS = 100
COLUMNS = (
    "fault",
    "passed",
    "that drive without torque after",
    "the other one",
    "on the bus and in the diagnosis",
)
SUMS = ("passed", "latest")
CYCLE = 0.001  # of the bus [s]
EARLIEST, LATEST = 0.8, 1.0  # begin of a fault [s]
LASTS = 0.1  # that the cause is there [s]
ENABLED_IN_VAIN, RESET, END = 0.2, 0.3, 0.6  # [s after the fault]
SHORTEST = LATEST + END
TIMEOUT = 0.010  # of set-points, of feedback, and of impossible values [s]
_HALF_STEP = 1e-6  # by which sums of periods may be off [s]
_SLOW = 0.02  # until a frame with faults and a heartbeat have come, both every 10 ms [s]
_SIDES = {"right": ("11", "front_right"), "left": ("12", "front_left")}  # circuit and wheel
_LEAST_TORQUE = 5.0  # of a drive that works [N m]
# A tenth of 360 N m is left at 138 degC, and the driver wants 61 to 122 [N m].
_DERATED = (20.0, 45.0)


class Fault(NamedTuple):
    """Kind and value as in test_bench.inject, and the name that it must get.

    Without a name the drive has to go on with it; with `both` the other drive stops as well.
    """

    kind: str
    value: float
    named: str
    both: bool = False


FAULTS = {
    "lost frames": Fault("lost_frames", 0.0, "CommandTimeout"),
    "wrong counter": Fault("wrong_counter", 0.0, "WrongCounter"),
    "wrong CRC": Fault("wrong_crc", 0.0, "WrongCrc"),
    "stale feedback: silent": Fault("silent", 0.0, "StaleFeedback"),
    "stale feedback: wrong CRC": Fault("feedback_wrong_crc", 0.0, "StaleFeedback"),
    "stale feedback: wrong counter": Fault("feedback_wrong_counter", 0.0, "StaleFeedback"),
    "derating by heat": Fault("hot_winding", 98.0, ""),
    "over-temperature, winding": Fault("hot_winding", 120.0, "WindingTemperature"),
    "over-temperature, inverter": Fault("hot_inverter", 80.0, "InverterTemperature"),
    "transducer offset": Fault("transducer_offset", 100.0, "Implausible"),
    "transducer gain": Fault("transducer_gain", 2.0, "Implausible"),
    "load machine at its limit": Fault("load_limit", 0.0, "Implausible"),
    "inverter trip": Fault("trip", 0.0, "Trip"),
    "inverter trip, both stop": Fault("trip", 0.0, "Trip", both=True),
    "DC-link loss": Fault("dc_link_loss", 0.0, "DcLinkLoss"),
    "DC-link loss, both stop": Fault("dc_link_loss", 0.0, "DcLinkLoss", both=True),
    "DC-link over-voltage": Fault("over_voltage", 200.0, "DcOverVoltage"),
    "over-current": Fault("over_current", 700.0, "OverCurrent"),
}


def trial(what: str, seed: int) -> Case:
    """A fault at a random instant, side and torque."""
    fault = FAULTS[what]
    chance = random.Random(f"{what} {seed}")
    # In this order: another one would draw other numbers.
    begin = EARLIEST + CYCLE * chance.randrange(round((LATEST - EARLIEST) / CYCLE))
    value = float(chance.randrange(64)) if fault.kind == "wrong_crc" else fault.value
    values = (
        ("test_bench", "inject.kind", fault.kind),
        ("test_bench", "inject.drive", chance.choice(tuple(_SIDES))),
        ("test_bench", "inject.value", value),
        ("test_bench", "inject.begin", begin),
        ("test_bench", "inject.end", begin + LASTS),
        ("inverter_gateway", "enable_at", begin + ENABLED_IN_VAIN),
        ("inverter_gateway", "reset_at", begin + RESET),
        ("inverter_gateway", "fault_stops", "both" if fault.both else "drive"),
        ("driver", "pedals.drive_torque", [chance.uniform(900.0, 1800.0)]),
    )
    return Case(f"{what} {seed}", SCENARIO, values, duration=begin + END)


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """When each torque was gone, the names on the bus, and how it went on."""
    injected = run.configurations["test_bench"].parameters.inject
    gateway = run.configurations["inverter_gateway"]
    side = injected.drive
    other = "left" if side == "right" else "right"
    t = recording.time - injected.begin
    since = 0.0
    if injected.kind == "load_limit":
        # Before the shaft is apart from the wheel nothing can be noticed.
        apart = _shaft_from_wheel(recording, side, gateway.common.vehicle.gear_ratio)
        is_noticed = (t > 0.0) & (apart > gateway.parameters.plausibility.speed)
        since = float(t[is_noticed][0])
    torque = _torque(recording, side)
    others = _torque(recording, other)
    faulty = (t > CYCLE) & (t < RESET)
    shown = (t > 0.0) & (t < LASTS + _SLOW)
    return {
        "gone_after": _gone_after(t, torque) - since,
        "other_gone_after": _gone_after(t, others),
        "least": float(np.abs(torque[(t > LASTS / 2) & (t < LASTS)]).max()),
        "before": float(torque[t < 0.0][-1]),
        "named": sorted(_named(recording, side, gateway.parameters.bus.database, shown)),
        "latched": bool(np.all(torque[(t > LASTS) & (t < RESET)] == 0.0)),
        "other_kept": bool(np.all(np.abs(others[faulty]) > _LEAST_TORQUE)),
        "back": bool(torque[-1] > _LEAST_TORQUE and others[-1] > _LEAST_TORQUE),
    }


def _torque(recording: Recording, side: str) -> np.ndarray:
    return recording.channels[f"bench.shafts.machine_torque.{_SIDES[side][1]}"]


def _gone_after(t: np.ndarray, torque: np.ndarray) -> float:
    """End of the last cycle with torque before the reset [s]; numbers are means of cycles."""
    return float(t[(t < RESET) & (torque != 0.0)][-1])


def _shaft_from_wheel(recording: Recording, side: str, gear_ratio: float) -> np.ndarray:
    """Distance of the speed of a shaft from that of its virtual wheel, (n,) [rad/s]."""
    _, wheel = _SIDES[side]
    turned = gear_ratio * recording.channels[f"wheel_states.velocity.{wheel}"]
    return np.abs(recording.channels[f"bench.shafts.speed.{wheel}"] - turned)


def _named(recording: Recording, side: str, database: str, when: np.ndarray) -> set[str]:
    """Names of all flags in the frames with faults of a drive and in heartbeats."""
    circuit, _ = _SIDES[side]
    drive = f"Drive{circuit}"
    frames = load_database(database)

    def flags(frame: str, payload: int) -> set[str]:
        return {name for name, value in frames[frame].values(payload).items() if value != 0.0}

    names: set[str] = set()
    low = recording.channels[f"can.feedback.drive_{circuit}_faults_low"][when]
    high = recording.channels[f"can.feedback.drive_{circuit}_faults_high"][when]
    for one, other in zip(low, high, strict=True):
        # A negative word stands for a cycle without a frame.
        if one >= 0.0:
            names |= flags(f"{drive}_Faults", joined(one, other))
    beats = recording.channels[f"can.set_points.heartbeat_{circuit}"][when]
    for beat in {int(each) for each in beats if each >= 0.0}:
        for name in flags("Ecu_Heartbeat", beat):
            if name.endswith(drive):
                names.add(name.removesuffix(drive))
    names -= {"Enable", "ErrorCode"}
    return {"StaleFeedback" if name == "Stale" else name for name in names}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the number of trials of each fault."""
    parser.add_argument(
        "--seeds",
        type=int,
        default=SEEDS,
        metavar="N",
        help=f"trials of each fault, default {SEEDS}",
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every fault with every seed."""
    if given.seeds < 1:
        raise ParameterError(f"--seeds: {given.seeds} is refused, expected 1 and more")
    return [trial(what, seed) for what in FAULTS for seed in range(given.seeds)]


def wrong(what: str, result: CaseResult) -> str:
    """Mistakes of a trial in a few words; empty if there are none."""
    if result.refused:
        return result.refused
    found, fault = result.measured, FAULTS[what]
    if not fault.named:
        derates = _DERATED[0] < found["least"] < _DERATED[1]
        is_named = found["named"] == ["Derating", "Warm"]
        return "" if derates and is_named and found["back"] else "it did not just derate"
    limit = TIMEOUT + CYCLE + _HALF_STEP
    in_diagnosis = any(note.endswith(f"drive: {fault.named}") for note in result.notes)
    other_is_right = found["other_gone_after"] <= limit if fault.both else found["other_kept"]
    checks = {
        "torque too late gone": found["gone_after"] <= limit,
        "not named on the bus": fault.named in found["named"],
        "not named in the diagnosis": in_diagnosis,
        "not latched": found["latched"],
        "the other drive": other_is_right,
        "not back after the reset": found["back"],
    }
    return ", ".join(text for text, good in checks.items() if not good)


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Trials that passed, and the latest zero torque of all faults that take the torque away."""
    passed = 0
    stopped: list[CaseResult] = []
    for what, fault in FAULTS.items():
        trials = _all(given, results, what)
        passed += sum(not wrong(what, result) for result in trials)
        if fault.named:
            stopped += trials

    def latest() -> float:
        return max(result.measured["gone_after"] for result in stopped)

    return {
        "passed": Metric(float(passed), "1"),
        "trials": Metric(float(len(results)), "1"),
        "latest_zero_torque": metric(latest, "s"),
    }


def tables(given: argparse.Namespace, results: Results) -> str:
    """Rows as aligned text, and the mistakes."""
    failures = set()
    for what in FAULTS:
        for result in _all(given, results, what):
            mistakes = wrong(what, result)
            if mistakes:
                failures.add(f"{what}: {mistakes}")
    return "\n".join([text_table(COLUMNS, rows(given, results), left=(0, 4)), *sorted(failures)])


def _all(given: argparse.Namespace, results: Results, what: str) -> list[CaseResult]:
    return [results[f"{what} {seed}"] for seed in range(given.seeds)]


def rows(given: argparse.Namespace, results: Results) -> Sequence[tuple[str, ...]]:
    """One row for each fault."""
    found = []
    for what, fault in FAULTS.items():
        trials = _all(given, results, what)
        passed = sum(not wrong(what, result) for result in trials)
        gone = _times(trials, "gone_after") if fault.named else "keeps a tenth"
        other = _times(trials, "other_gone_after") if fault.both else "keeps its torque"
        found.append((what, f"{passed} of {len(trials)}", gone, other, fault.named or "Derating"))
    return found


def _times(trials: Sequence[CaseResult], quantity: str) -> str:
    times = [result.measured[quantity] for result in trials if not result.refused]
    return f"{1e3 * min(times):.0f} to {1e3 * max(times):.0f} ms" if times else "-"
