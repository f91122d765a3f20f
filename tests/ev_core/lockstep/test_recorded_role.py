"""A recording of one's own that plays a role.

Any kind of numbers, whole and in order, or one line.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import ev_stack
from ev_msgs_py.refusal import ParameterError

DURATION = 0.5
TORQUE, BRAKE = "driver.command.drive_torque", "driver.command.brake_torque"


@pytest.fixture(scope="module")
def recorded() -> ev_stack.Result:
    return ev_stack.run("shchur2019", duration=DURATION)


def arrays_of(recorded: ev_stack.Result) -> dict[str, np.ndarray]:
    return {
        "time": np.array(recorded.time),
        **{name: np.array(each) for name, each in recorded.signals.items()},
    }


def played(folder: Path, arrays: dict[str, np.ndarray]) -> ev_stack.Result:
    file = folder / "mine.npz"
    np.savez(file, **arrays)
    return ev_stack.run("shchur2019", method={"driver": str(file)}, duration=DURATION)


def test_it_plays_the_run_again(recorded, tmp_path):
    assert played(tmp_path, arrays_of(recorded)).hash == recorded.hash


@pytest.mark.parametrize("kind", [np.float32, np.int64, np.uint8])
def test_numbers_of_any_kind_are_played(recorded, tmp_path, kind):
    arrays = arrays_of(recorded)
    arrays[TORQUE] = np.abs(arrays[TORQUE]).astype(kind)
    assert (played(tmp_path, arrays).signals[TORQUE] == arrays[TORQUE].astype(float)).all()


def test_a_brake_torque_that_is_negative_by_rounding_is_none(recorded, tmp_path):
    arrays = arrays_of(recorded)
    arrays[BRAKE] = arrays[BRAKE] - 1e-17
    assert played(tmp_path, arrays).hash == recorded.hash


def shuffled(times: np.ndarray) -> np.ndarray:
    return np.concatenate([times[:10], times[10:20][::-1], times[20:]])


def with_last(number: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda times: np.append(times[:-1], number)


WRONG = {
    "no instants": (
        None,
        lambda column: column[:0],
        "the file has no instants, expected one or more",
    ),
    "short column": (
        TORQUE,
        lambda column: column[:-3],
        rf"{TORQUE} has 48 numbers, time has 51, expected as many",
    ),
    "long column": (
        TORQUE,
        lambda column: np.append(column, 0.0),
        rf"{TORQUE} has 52 numbers, time has 51, exp",
    ),
    "short time": (
        "time",
        lambda times: times[:-3],
        "has 51 numbers, time has 48, expected as many",
    ),
    "time is no number": ("time", with_last(np.nan), "time 50 is nan, expected a finite number"),
    "time without end": ("time", with_last(np.inf), "time 50 is inf, expected a finite number"),
    "number is none": (TORQUE, with_last(np.nan), rf"{TORQUE} 50 is nan, expected a finite number"),
    "number without end": (
        BRAKE,
        with_last(np.inf),
        rf"{BRAKE} 50 is inf, expected a finite number",
    ),
    "out of order": (
        "time",
        shuffled,
        r"time 10 is 0\.19 s, expected 0\.1 s: the instants follow each other by",
    ),
    "negative brake": (BRAKE, with_last(-2.0), rf"{BRAKE} 50 is -2\.0, expected 0 or more"),
    "late end": (
        "time",
        with_last(0.6),
        r"51 instants up to 0\.6 s are none of a control_period of 0\.01 s",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_series_of_instants_is_refused(recorded, tmp_path, name):
    column, change, message = WRONG[name]
    arrays = {
        key: change(each) if column in (None, key) else each
        for key, each in arrays_of(recorded).items()
    }
    with pytest.raises(ParameterError, match=rf"driver method .*mine\.npz: .*{message}") as refused:
        played(tmp_path, arrays)
    assert "\n" not in str(refused.value)
