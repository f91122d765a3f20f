"""Measures of the distance of two series, on series with known answers."""

from __future__ import annotations

import numpy as np
import pytest

from ev_study.measured.replays.errors import by_range, by_window, errors_of, spins

TIME = np.arange(1001) * 0.01
SINE = np.sin(2.0 * TIME)[None] * np.ones((2, 1))


def test_a_shifted_and_biased_sine():
    """sin(2 (t - 0.0333)) + 0.1.

    A lag of 33.3 ms between samples, a bias of 0.1 with what a cut period adds.
    """
    late = np.sin(2.0 * (TIME - 0.0333))[None] * np.ones((2, 1)) + 0.1
    found = errors_of(late, SINE, 0.01)
    assert found.lag == pytest.approx(0.0333, abs=1e-3)
    assert found.bias == pytest.approx(0.1, abs=0.01)
    assert found.rms == pytest.approx(
        np.sqrt(0.1**2 + 0.0666**2 / 2), rel=0.05
    )  # 2 sin(0.0333) cos of amplitude 0.0666
    assert found.explained == pytest.approx(1.0 - 0.0666**2, abs=1e-3)


def test_windows_ranges_and_a_window_that_left():
    simulated = SINE + np.array([[0.1], [0.2]])
    assert by_window(simulated, SINE) == pytest.approx([0.1, 0.2])
    of = by_range(simulated, SINE, np.array([[1.0], [9.0]]) * np.ones_like(SINE))
    assert {name: each.rms for name, each in of.items()} == pytest.approx(
        {"0 to 2": 0.1, "above 8": 0.2}
    )
    gone = np.zeros((3, 5))
    gone[1, 3], gone[2, 4] = np.radians(21.0), np.nan
    assert spins(gone, np.zeros((3, 5))).tolist() == [False, True, True]
