"""Output of one sensor."""

from __future__ import annotations

import math
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensors.rows import EVERYTHING, sensors, shown

from ev_core.compiled.part import RowPart
from ev_core.compiling.machine_code import call
from ev_core.sensors.random_numbers import philox
from ev_core.sensors.row import QUANTITIES, SensorRow
from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError

PERIODS = 20_000


def test_noise_is_white_and_gaussian_with_its_standard_deviation():
    """Tolerances of four standard errors.

    Mean 1/sqrt(N), deviation 1/sqrt(2 N), correlation 1/sqrt(N), tail.
    """
    error = shown(np.full(PERIODS, 5.0), noise=0.2, bias=0.3) - 5.0
    normal = (error - 0.3) / 0.2
    assert abs(normal.mean()) < 4 / math.sqrt(PERIODS)
    assert normal.std() == pytest.approx(1.0, abs=4 / math.sqrt(2 * PERIODS))
    assert abs((normal[1:] * normal[:-1]).mean()) < 4 / math.sqrt(PERIODS)
    beyond = 0.0455  # share beyond two standard deviations
    assert (np.abs(normal) > 2).mean() == pytest.approx(beyond, abs=4 * math.sqrt(beyond / PERIODS))


def test_quantisation_gives_the_nearest_multiple():
    true = np.linspace(-3.0, 3.0, 1001)
    got = shown(true, quantisation=0.1)
    steps = got / 0.1
    assert np.abs(steps - np.round(steps)).max() < 1e-12
    assert np.abs(got - true).max() <= 0.05 + 1e-12
    assert len(set(got.tolist())) == 61  # one number for each step, to the last bit


@settings(max_examples=50, derandomize=True, deadline=None)
@given(
    range_=st.tuples(st.floats(-2.0, -0.01), st.floats(0.01, 2.0)),
    quantisation=st.floats(0.01, 1.0),
)
def test_quantisation_shows_nothing_beyond_the_range(range_, quantisation):
    """The last step within the range is the largest shown number, as of a coarse converter."""
    lowest, highest = range_
    true = np.linspace(-3.0, 3.0, 201)
    got = shown(true, quantisation=quantisation, lowest=lowest, highest=highest)
    assert lowest <= got.min() and got.max() <= highest
    steps = got / quantisation
    assert np.abs(steps - np.round(steps)).max() < 1e-9
    within = (true >= lowest + quantisation) & (true <= highest - quantisation)
    assert (got[within] == shown(true, quantisation=quantisation)[within]).all()
    assert (shown(got, quantisation=quantisation) == got).all()  # a step, to the last bit


def test_delay_is_whole_periods_and_the_first_value_holds_until_then():
    true = np.arange(10.0)
    assert shown(true, delay=3).tolist() == [0, 0, 0, 0, 1, 2, 3, 4, 5, 6]


def test_a_lost_value_leaves_the_last_one():
    """A ramp: each shown value is the true one of this period or what was shown before."""
    true = np.arange(1.0, PERIODS + 1)
    got = shown(true, dropout=0.3)
    lost = got != true
    assert got[0] == 1.0
    assert (got[1:][lost[1:]] == got[:-1][lost[1:]]).all()
    assert lost.mean() == pytest.approx(0.3, abs=4 * math.sqrt(0.3 * 0.7 / PERIODS))
    assert shown(true, dropout=1.0).tolist() == [1.0] * PERIODS


def test_no_parameter_changes_what_is_drawn():
    """Noise alone, with bias, with delay, and with drop-out: the same noise at the same time."""
    true = np.zeros(500)
    noise = shown(true, noise=0.5)
    assert (shown(true, noise=1.0) == 2 * noise).all()
    assert (shown(true, noise=0.5, bias=1.0) == 1.0 + noise).all()
    assert (shown(true, noise=0.5, delay=2)[2:] == noise[:-2]).all()
    with_losses = shown(true, noise=0.5, dropout=0.5)
    lost = shown(np.arange(500.0), dropout=0.5) != np.arange(500.0)
    assert 150 < lost.sum() < 350
    assert (with_losses[~lost] == noise[~lost]).all()


def test_seed_and_name_choose_the_random_numbers():
    true = np.zeros(100)
    noise = shown(true, noise=1.0)
    assert (shown(true, noise=1.0) == noise).all()
    for other in ({"seed": 1}, {"name": "body_yaw_rate"}):
        # four standard errors
        assert abs(np.corrcoef(noise, shown(true, noise=1.0, **other))[0, 1]) < 0.4


def test_the_numbers_are_drawn_as_the_documentation_says():
    """docs/sensors.md, written out; math rounds its functions otherwise, by some 1e-16."""
    seed, period, number = 7, 5, 3
    w = philox(period, 0, number // 2, 0, seed, zlib.crc32(b"wheel_speed"))
    radius = math.sqrt(-2 * math.log(1 - ((w[0] >> 5) * 2**26 + (w[1] >> 6)) / 2**53))
    drawn = radius * math.sin(math.tau * ((w[2] >> 5) * 2**26 + (w[3] >> 6)) / 2**53)
    got = shown(np.zeros((period + 1, 4)), seed, "wheel_speed", noise=1.0)
    assert got[period, number] == pytest.approx(drawn, rel=1e-14)


def test_the_random_numbers_are_these():
    """Recorded, so that a run with noise stays the same."""
    recorded = [1.4270278485427044, -1.3622989742718303, -0.38887829163564336]
    assert shown(np.zeros(3), noise=1.0, seed=7).tolist() == recorded


def test_numbers_of_a_sensor_are_independent():
    """All correlations of the eight tyre forces within four standard errors."""
    correlation = np.corrcoef(shown(np.zeros((2000, 8)), name="tire_force", noise=1.0).T) - np.eye(
        8
    )
    assert np.abs(correlation).max() < 4 / math.sqrt(2000)


def test_all_numbers_are_lost_at_once():
    true = np.arange(1000.0)[:, None] + np.arange(4) / 8
    got = shown(true, name="wheel_speed", dropout=0.5)
    assert (np.diff(got - got[:, :1]) == np.diff(true - true[:, :1])).all()
    assert len(set(got[:, 0])) < 600


def test_a_heading_has_errors_as_an_angle():
    """The angle may jump by a turn, behind the car."""
    heading = np.linspace(-3.0, 3.0, 50)
    pose = np.array([np.sin(heading / 2), np.cos(heading / 2)]).T
    got = shown(pose, name="body_heading", bias=0.5, delay=3)
    assert np.hypot(*got.T) == pytest.approx(np.ones(50), rel=1e-15)
    error = 2 * np.arctan2(*got.T)[3:] - heading[:-3] - 0.5
    assert np.remainder(error + 1.0, math.tau) == pytest.approx(np.ones(47), rel=1e-14)


def test_a_charge_is_its_share_of_the_capacity():
    """Share and charge agree in the single precision of the messages."""
    got = shown(np.array([[0.75, 30.0, 40.0]] * 100), name="battery_state_of_charge", noise=0.1)
    assert len(set(got[:, 0])) == 100
    assert (got == got.astype(np.float32)).all()
    assert got[:, 1] == pytest.approx(40.0 * got[:, 0], rel=2**-24)
    assert (got[:, 2] == 40.0).all()


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_what_is_not_finite_is_left_to_the_publisher(value):
    """The number passes unchanged: its message is refused by name."""
    assert shown(np.array([value]), quantisation=0.1).tolist() == pytest.approx(
        [value], nan_ok=True
    )


# Compiled


@pytest.mark.parametrize("seed", range(4))
def test_compiled_sensors_show_the_same_bits(seed):
    """All quantities at once, each with errors of its own."""
    random = np.random.default_rng(seed)
    errors = {
        quantity.name: {
            "noise": random.uniform(0.0, 0.1),
            "bias": random.uniform(-1.0, 1.0),
            "quantisation": random.choice([0.0, 1e-3]),
            "delay": int(random.integers(0, 4)),
            "dropout": random.choice([0.0, 0.5]),
        }
        for quantity in QUANTITIES
    }
    plain, part = SensorRow(sensors(errors), seed), RowPart(SensorRow(sensors(errors), seed))
    function, state, constants = part.addresses()
    for _ in range(50):
        true = random.normal(size=frame.SIZE)
        numbers = true.tolist()
        plain.step(numbers)
        assert call(function, 0, true.ctypes.data, state, constants) == 0
        assert true.tobytes() == np.array(numbers).tobytes()
        assert part.state.tobytes() == np.array(plain.state).tobytes()


def test_a_restarted_row_shows_the_same_again():
    """A view of memory, as nodes have it, is as good as a list."""
    row = SensorRow(sensors({"wheel_speed": EVERYTHING, "imu_yaw_rate": EVERYTHING}), 3)
    runs = []
    for kind in (list, memoryview):
        row.start()
        shown = []
        for k in range(20):
            numbers = np.full(frame.SIZE, float(k))
            row.step(memoryview(numbers) if kind is memoryview else (given := numbers.tolist()))
            shown.append(list(numbers) if kind is memoryview else given)
        runs.append(shown)
    assert runs[0] == runs[1] != [[float(k)] * frame.SIZE for k in range(20)]


def test_errors_as_shares_of_reading_and_range_add_up():
    """Twice the reading, twice the error; 1 % of a range of 200 is 2, whatever the reading."""
    unit = shown(np.zeros(500), noise=1.0)
    for reading in (0.0, -10.0, 20.0):
        true = np.full(500, reading)
        of_reading = shown(true, noise_of_reading=0.02) - reading
        assert of_reading == pytest.approx(0.02 * abs(reading) * unit, abs=1e-12)
        both = {"lowest": -100.0, "highest": 100.0, "bias_of_range": -0.005, "noise_of_range": 0.01}
        assert shown(true, **both) - reading == pytest.approx(-1.0 + 2.0 * unit, abs=1e-12)
    assert shown(np.zeros(9), noise_of_reading=0.5).tolist() == [0.0] * 9


@pytest.mark.parametrize(
    ("errors", "words"),
    [
        ({"noise_of_range": 0.01}, "noise_of_range needs a range: lowest and highest"),
        ({"bias_of_range": 0.01, "lowest": 0.0}, "bias_of_range needs a range: lowest and highest"),
        ({"lowest": 1.0, "highest": 0.0}, "lowest is 1, expected at most highest, 0"),
    ],
)
def test_a_share_of_no_range_is_refused(errors, words):
    with pytest.raises(ParameterError, match=words):
        shown(np.zeros(1), **errors)
