"""Faults of numbers in messages, one by one, in frames without a graph.

Compiled they are the same.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.compiled.part import RowPart
from ev_core.compiling.machine_code import call
from ev_core.faults.fault import OF_SIGNALS
from ev_core.faults.row import FaultRow, of_signals
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import WheelTorqueCommand

PLACE = frame.channels()
PERIOD = 0.01
SINGLE = [
    p
    for s in ROLES["plant"].writes
    for p, one in zip(frame.places(s), shape_of(s).single, strict=True)
    if one
]
YAW, LEFT, RIGHT = (
    "imu.yaw_rate",
    "wheel_states.velocity.front_left",
    "wheel_states.velocity.front_right",
)


def struck(*texts: str, steps: int = 12, seed: int = 0, compiled: bool = False) -> np.ndarray:
    """Frames behind the faults of the plant.

    Each number is its place plus a thousandth of the period.
    """
    frames = np.arange(frame.SIZE) + 1e-3 * np.arange(steps)[:, None]
    frames[:, frame.TIME] = PERIOD * np.arange(steps)
    frames[:, SINGLE] = frames[:, SINGLE].astype(np.float32)
    row = FaultRow(of_signals(texts), ROLES["plant"].writes, seed, PERIOD)
    part = RowPart(row)
    function, state, constants = part.addresses()
    for numbers in frames:
        if compiled:
            assert call(function, 0, numbers.ctypes.data, state, constants) == 0
        else:
            row.step(numbers)
    return frames


def change(text: str, channel: str = YAW, **of: int) -> list[float]:
    """Difference of a number with a fault from that without, in each period, rounded."""
    return (struck(text, **of) - struck(**of))[:, PLACE[channel]].round(9).tolist()


BRAKE = frame.PLACES[WheelTorqueCommand].start + shape_of(WheelTorqueCommand).unsigned_commands[0]
BRAKES = "torque_command.brake.front_left"


@pytest.mark.parametrize("compiled", [False, True])
@settings(max_examples=40)
@given(
    kind=st.sampled_from(("constant", "scaled", "offset", "noisy", "swapped")),
    value=st.floats(-100.0, 100.0),
    brake=st.floats(0.0, 50.0),
)
def test_no_fault_makes_a_brake_torque_negative(compiled, kind, value, brake):
    """A brake gives none or more, whatever it is sent; a drive torque has either sign."""
    numbers = np.zeros(frame.SIZE)
    numbers[BRAKE], numbers[BRAKE - 4] = brake, value
    other = "torque_command.drive.front_left"
    text = (
        f"swapped {BRAKES},{other}"
        if kind == "swapped"
        else f"{kind} {BRAKES} {abs(value) if kind == 'noisy' else value}"
    )
    row = FaultRow(of_signals((text,)), (WheelTorqueCommand,), 0, PERIOD)
    if compiled:
        function, state, constants = RowPart(row).addresses()
        assert call(function, 0, numbers.ctypes.data, state, constants) == 0
    else:
        row.step(numbers)
    expected = {
        "constant": value,
        "scaled": brake * value,
        "offset": brake + value,
        "swapped": value,
    }
    assert numbers[BRAKE] >= 0.0
    if kind in expected:
        assert numbers[BRAKE] == max(expected[kind], 0.0)
        assert numbers[BRAKE - 4] == (brake if kind == "swapped" else value)


OFF = [0.0]


def test_values_between_begin_and_end():
    """Periods 3 to 5 change, and no other number."""
    assert change("offset imu.yaw_rate 2 from 0.03 until 0.06") == OFF * 3 + [2.0] * 3 + OFF * 6
    assert change("offset imu.yaw_rate 2 from 0.03 until 0.06", RIGHT) == OFF * 12
    yaw, acceleration = (struck()[:, PLACE[name]] for name in (YAW, "imu.lateral_acceleration"))
    assert change("constant imu 0") == (-yaw).round(9).tolist()
    assert change("scaled imu.yaw_rate -0.5") == (-1.5 * yaw).round(9).tolist()
    shown = struck("tilted imu.lateral_acceleration 0.1")[:, PLACE["imu.lateral_acceleration"]]
    assert shown == pytest.approx(acceleration * math.cos(0.1) + 9.81 * math.sin(0.1), abs=1e-3)


def test_swapped_are_in_each_others_place():
    apart = float(PLACE[RIGHT] - PLACE[LEFT])
    text = f"swapped {LEFT},{RIGHT} from 0.1"
    assert change(text, LEFT) == OFF * 10 + [apart] * 2
    assert change(text, RIGHT) == OFF * 10 + [-apart] * 2


def test_what_remembers():
    """Each period adds 0.001: so many thousandths a number is old."""
    assert change("frozen imu from 0.03 until 0.06") == OFF * 3 + [-0.001, -0.002, -0.003] + OFF * 6
    assert change("delayed imu 0.02 from 0.04") == OFF * 4 + [-0.002] * 8
    assert change("lost imu 1 from 0.1") == OFF * 10 + [-0.001, -0.002]
    assert change("lost imu 0") == change("reordered imu 0") == OFF * 12
    assert change("reordered imu 1") == OFF + [-0.001] * 11


def test_chance_is_that_of_the_seed():
    """A third of 2000 periods is lost, within four standard deviations; the whole topic at once."""
    text = "lost imu 0.3333"
    one, two, other = (struck(text, steps=2000, seed=seed) for seed in (1, 1, 2))
    assert (one == two).all() and (one != other).any()
    lost = np.diff(one[:, PLACE[YAW]]) == 0.0
    assert abs(lost.mean() - 1 / 3) < 4 * math.sqrt(2 / 9 / 2000)
    assert (np.diff(one[:, PLACE["imu.lateral_acceleration"]]) == 0.0).tolist() == lost.tolist()
    noise = (struck("noisy imu.yaw_rate 0.5", steps=2000) - struck(steps=2000))[:, PLACE[YAW]]
    # the standard error of a deviation
    assert abs(noise.std() - 0.5) < 4 * 0.5 / math.sqrt(2 * 2000)
    assert abs(noise.mean()) < 4 * 0.5 / math.sqrt(2000)


@pytest.mark.parametrize("kind", [kind for kind in OF_SIGNALS if kind != "tilted"])
def test_what_is_shown_is_what_its_message_carries(kind):
    """Numbers of single precision and others, also in each other's place.

    Else the ways of running would differ.
    """
    where = "battery.voltage,twist.longitudinal" if kind == "swapped" else "battery"
    text = f"{kind} {where}{' 0.1' if OF_SIGNALS[kind].has_value else ''} from 0.03"
    for compiled in (False, True):
        shown = struck(text, compiled=compiled)[:, SINGLE]
        assert (shown == shown.astype(np.float32)).all()


def test_two_faults_of_the_same_text_have_random_numbers_of_their_own():
    """The sum of two has sqrt(2) of the deviation and not twice.

    The first one is what it is alone.
    """
    text, steps = "noisy imu.yaw_rate 0.5", 2000
    one, two, sound = (
        struck(*texts, steps=steps)[:, PLACE[YAW]] for texts in ((text,), (text, text), ())
    )
    first, second = one - sound, two - one
    assert (two - sound).std() == pytest.approx(
        0.5 * math.sqrt(2.0), abs=4 * 0.5 / math.sqrt(steps)
    )
    assert abs(np.corrcoef(first, second)[0, 1]) < 4 / math.sqrt(steps)


@given(
    st.lists(
        st.tuples(
            st.sampled_from([k for k in OF_SIGNALS if k not in ("swapped", "tilted", "restarted")]),
            st.sampled_from(["imu", "wheel_states", "battery", "tire_forces.load", "pose"]),
            st.floats(0.0, 1.0),
            st.integers(0, 8),
            st.integers(1, 8),
        ),
        min_size=1,
        max_size=4,
    )
)
@settings(max_examples=25)
def test_never_a_number_that_is_not_finite_and_compiled_the_same(drawn):
    texts = [
        f"{kind} {where} {max(value, 1e-3)} from {begin / 100} until {(begin + length) / 100}"
        if OF_SIGNALS[kind].has_value
        else f"{kind} {where} from {begin / 100}"
        for kind, where, value, begin, length in drawn
    ]
    plain = struck(*texts, steps=20)
    assert np.isfinite(plain).all()
    assert plain.tobytes() == struck(*texts, steps=20, compiled=True).tobytes()
