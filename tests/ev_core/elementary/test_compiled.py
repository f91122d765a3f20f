"""Compiled code gives the same bits as Python."""

from __future__ import annotations

import math

import numpy as np
import pytest
from elementary.precise import ONE, TWO, compiled

from ev_core import elementary

pytestmark = pytest.mark.slow

COUNT = 100_000
SPECIAL = (
    0.0,
    -0.0,
    1.0,
    -1.0,
    5e-324,
    -2.2e-308,
    1.7e308,
    1048576.0,
    709.75,
    -745.0,
    math.inf,
    -math.inf,
    math.nan,
)


def any_numbers(seed: int) -> np.ndarray:
    """Doubles of all sizes, and as many near 1; then those of note."""
    generator = np.random.default_rng(seed)
    everywhere = generator.integers(0, 2**64, COUNT // 4, dtype=np.uint64).view(float)
    angles = generator.uniform(-1.0, 1.0, COUNT // 4) * 2.0 ** generator.integers(0, 40, COUNT // 4)
    near = generator.uniform(-1.0, 1.0, COUNT // 4)
    moderate = generator.uniform(-30.0, 30.0, COUNT // 4)
    return np.concatenate([near, moderate, angles, everywhere, SPECIAL])


def assert_same_bits(ours: np.ndarray, python: np.ndarray) -> None:
    both_nan = np.isnan(ours) & np.isnan(python)
    different = (ours.view(np.uint64) != python.view(np.uint64)) & ~both_nan
    assert not different.any(), np.flatnonzero(different)


@pytest.mark.parametrize("name", ONE)
@pytest.mark.sampled
def test_one_argument(name):
    function, x = getattr(elementary, name), any_numbers(1)
    out = np.empty_like(x)
    compiled(function, 1)(x, out)
    assert_same_bits(out, np.array([function(value) for value in x.tolist()]))


@pytest.mark.parametrize("name", [*TWO, "remainder", "fmod"])
def test_two_arguments(name):
    function, x = getattr(elementary, name), any_numbers(2)
    y = np.random.default_rng(3).permutation(x)
    y[: COUNT // 2] = any_numbers(4)[: COUNT // 2]
    out = np.empty_like(x)
    compiled(function, 2)(x, y, out)
    assert_same_bits(
        out, np.array([function(*values) for values in zip(x.tolist(), y.tolist(), strict=True)])
    )


def sine_less_twice_cosine(x: float) -> float:
    sine, cosine = elementary.sin_cos(x)
    return sine - 2.0 * cosine


def test_sine_and_cosine_together():
    x = any_numbers(5)
    out = np.empty_like(x)
    compiled(sine_less_twice_cosine, 1)(x, out)
    assert_same_bits(out, np.array([sine_less_twice_cosine(value) for value in x.tolist()]))
