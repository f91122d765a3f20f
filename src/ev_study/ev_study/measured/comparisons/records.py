"""A record of a car on a track, a tyre on its rig and the energy of a list of cars, in numbers that are compared.

How it works: each function takes the folder of the data and gives numbers by the id of a
comparison. It does what the command of that comparison does, with the car, mapping and parameters
of config/measured.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.data_file import find_in_config
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides
from ev_study.measured.motor_map import fit_motor
from ev_study.measured.records.mapping import read_record
from ev_study.measured.records.record import SIDESLIP, YAW_RATE, MeasuredRecord
from ev_study.measured.replays.estimates import estimates_of
from ev_study.measured.replays.open_loop import OpenLoop, graph, windows_of
from ev_study.measured.replays.validation import Validation, signals_to_show
from ev_study.measured.rig import read_rig
from ev_study.measured.tyre_fit import KINDS, fit_tyre
from ev_study.studies import energy
from ev_study.studies.driving import drive_cases

TRAINING, HELD_OUT = (0.0, 2.0 / 3.0), (2.0 / 3.0, 1.0)
WINDOW = 5.0  # s
# [s] by which windows begin later: with all of them, at each second
SHIFTS = (0.0, 1.0, 2.0, 3.0, 4.0)


def track_record(folder: Path) -> dict[str, float]:
    """Errors of the identified Ferrari 250 LM on what it was fitted to and what was held out, and of the observer."""
    car = find_in_config("measured/ferrari_250lm")
    if car is None:
        raise ParameterError("measured/ferrari_250lm is in no config folder")
    record = read_record(folder / "ferrari_250lm_1.csv.xz", car / "record.yaml")
    beside = Overrides(files=[str(car / "identified_parameters.yaml")])
    configurations = graph(str(car / "identified.yaml"), record.period, beside)
    duration, (begin, end) = len(record.valid) * record.period, HELD_OUT
    # Windows of the training part, then of what was held out, shifted by whole seconds.
    first = _driven(record, configurations, *TRAINING)
    last = [_driven(record, configurations, begin + shift / duration, end) for shift in SHIFTS]
    found = {"track_windows_left": float(last[0].spun.sum())}
    found["track_windows_left_each_second"] = float(sum(each.spun.sum() for each in last))
    yaw, angle = (
        [part.judged[signal] for part in (first, last[0])] for signal in (YAW_RATE, SIDESLIP)
    )
    found["track_yaw_rate"], found["track_yaw_rate_held_out"] = (each.errors.rms for each in yaw)
    found["track_sideslip"] = float(np.degrees(angle[0].errors.rms))
    found["track_sideslip_held_out"] = float(np.degrees(angle[1].median_window))
    of_windows = [each.judged[SIDESLIP].of_windows for each in last]
    found["track_sideslip_each_second"] = float(np.degrees(np.median(np.concatenate(of_windows))))
    believed = ParameterFile(car / "estimators.yaml").values_for(
        "/ev/slip_angle_observer", by_name=True
    )
    # The observer is fitted to no part of the record here, so all of it counts.
    whole = OpenLoop(record, windows_of(record, WINDOW), configurations)
    estimates = {
        each.name: each.judged for each in estimates_of(whole, {"slip_angle_observer": believed})[0]
    }
    found["track_observer"] = float(np.degrees(estimates["slip_angle_observer"].errors.rms))
    return found


def _driven(
    record: MeasuredRecord, car: Mapping[str, Configuration], begin: float, end: float
) -> Validation:
    replay = OpenLoop(record, windows_of(record, WINDOW, begin, end), car, signals_to_show())
    return Validation(replay, {name: values[0] for name, values in replay.simulate().items()}, 0.0)


def tyre_rig(folder: Path) -> dict[str, float]:
    """Errors of the tyre fit on sweeps that it has not seen, in per cent of the largest force."""
    files = [folder / f"tyre_rig_{name}.csv.xz" for name in ("cornering", "drivebrake")]
    unseen = fit_tyre(read_rig(files)).unseen
    return {f"tyre_{kind.replace(' ', '_')}": 100.0 * unseen[kind] for kind in KINDS}


def motor_map(folder: Path) -> dict[str, float]:
    """Errors of a motor's fitted losses on points that the fit has not seen, in percentage points of efficiency."""
    median, ninety, _ = fit_motor(folder / "id3_motor_map.csv").errors(held_out=True)
    return {"motor_map_median": median, "motor_map_ninety": ninety}


def electric_cars(folder: Path) -> dict[str, float]:
    """Errors of the study `energy` on all cars of the list and on those new to the assumptions, in per cent."""
    given = argparse.Namespace(
        cars=folder / "epa_2022_electric_cars.csv", assumptions=None, fit=False, only=[]
    )
    cases = energy.cases(given)
    results = dict(
        zip([case.name for case in cases], drive_cases(cases, energy.measure), strict=True)
    )
    return {
        f"energy_{name}": 100.0 * float(metric.value or 0.0)
        for name, metric in energy.metrics(given, results).items()
    }
