"""Least squares of y = A x + B sqrt(x) over the last samples (dissertation, eq 2.36)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers.traction import numbers_of
from hypothesis import given
from hypothesis import strategies as st

from ev_control.estimation.slip_curve_fit import (
    CAPACITY,
    FittedCurve,
    SlipCurveFit,
    SlipCurveParameters,
    Template,
    add_sample,
    fitted_curve,
    fitted_peak,
    is_full,
    mean_slip,
    slip_variance,
    slope,
)
from ev_control.estimation.wheel_dynamics import start_again
from ev_sim.surfaces import SURFACES

SIZE, OFFSET = 25.0, 1e-4
DEFAULT = numbers_of(SlipCurveParameters())


def sums(fit: SlipCurveFit) -> tuple[float, ...]:
    return fit.sum_x, fit.sum_xx, fit.sum_x_root, fit.sum_xy, fit.sum_root_y


def sums_of(samples: list[tuple[float, float]], offset: float = OFFSET) -> tuple[float, ...]:
    """The sums of the normal equations, by numpy."""
    x = np.maximum(np.array([slip for slip, _ in samples]), 0.0)
    y, root = np.array([torque for _, torque in samples]), np.sqrt(x + offset)
    return x.sum(), (x * x).sum(), (x * root).sum(), (x * y).sum(), (root * y).sum()


def fitted(slips: np.ndarray, curve) -> SlipCurveFit:
    fit = SlipCurveFit()
    for x in slips.tolist():
        add_sample(fit, SIZE, OFFSET, x, curve(x))
    return fit


samples_of = st.tuples(st.floats(-0.1, 1.0), st.floats(-1.0, 1.0))


@given(samples=st.lists(samples_of, min_size=25, max_size=120))
def test_running_sums_are_those_of_the_window(samples):
    """The normal equations after every sample are those of the last 25, within rounding."""
    fit = SlipCurveFit()
    for slip, torque in samples:
        add_sample(fit, SIZE, OFFSET, slip, torque)
    expected = sums_of(samples[-25:])
    assert sums(fit) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert mean_slip(fit) == pytest.approx(expected[0] / 25.0, rel=1e-12, abs=1e-12)
    assert is_full(fit)


@given(
    samples=st.lists(samples_of, min_size=1, max_size=80),
    changes=st.lists(
        st.tuples(st.integers(2, 60), st.sampled_from((1e-4, 1e-2)), samples_of),
        min_size=1,
        max_size=6,
    ),
)
def test_a_changed_window_or_offset_holds_from_the_next_sample_on(samples, changes):
    """Shorter or longer, as far as there are samples.

    The sums are those of the new window at once.
    """
    fit, taken = SlipCurveFit(), []
    for slip, torque in samples:
        add_sample(fit, SIZE, OFFSET, slip, torque)
        taken.append((slip, torque))
    for size, offset, sample in changes:
        add_sample(fit, float(size), offset, *sample)
        taken.append(sample)
        assert sums(fit) == pytest.approx(sums_of(taken[-size:], offset), rel=1e-12, abs=1e-12)
        assert is_full(fit) is (len(taken) >= size)


def test_rounding_errors_do_not_pile_up():
    """Sums of a million slips over ten orders are right to 1e-13: each window starts new ones.

    A sum that only gained and lost samples would be off by some 1e-10 of the largest one.
    """
    fit, last = SlipCurveFit(), []
    for n in range(40 * 25 * 40):
        x = 1.0 if n % 40 == 0 else 1e-10 * (n % 7)
        add_sample(fit, SIZE, 0.0, x, x)
        last.append((x, x))
    expected = [math.fsum(x for x, _ in last[-25:]), math.fsum(x * x for x, _ in last[-25:])]
    assert [fit.sum_x, fit.sum_xx] == pytest.approx(expected, rel=1e-13, abs=1e-25)


def test_a_window_beyond_the_capacity_is_cut_to_it():
    fit = SlipCurveFit()
    samples = [(0.1 + 0.05 * math.sin(n), 0.5) for n in range(CAPACITY + 300)]
    for slip, torque in samples:
        add_sample(fit, 5000.0, OFFSET, slip, torque)
    assert fit.size == CAPACITY
    assert sums(fit) == pytest.approx(sums_of(samples[-CAPACITY:]), rel=1e-12)


def test_forgotten_samples_are_gone():
    fit = SlipCurveFit()
    for n in range(30):
        add_sample(fit, SIZE, OFFSET, 0.01 * n, 0.5)
    start_again(SlipCurveFit)(fit)
    add_sample(fit, SIZE, OFFSET, 0.2, 0.7)
    assert sums(fit) == pytest.approx(sums_of([(0.2, 0.7)]), rel=1e-15)
    assert not is_full(fit)


def test_the_fit_gives_its_own_curve_back():
    """The curve y = -4 x + 2 sqrt(x + e) has its peak where sqrt(x + e) = 2/8."""
    fit = fitted(np.linspace(0.01, 0.12, 25), lambda x: -4.0 * x + 2.0 * math.sqrt(x + OFFSET))
    assert fitted_curve(fit) == pytest.approx((-4.0, 2.0), rel=1e-9)
    assert fitted_peak(DEFAULT, fit) == pytest.approx(1 / 16 - 1e-4, rel=1e-9)


def test_mean_and_variance_by_hand():
    """Slips of 0.1 and 0.3 in turn, twelve and thirteen of them."""
    fit = fitted(np.array([0.1, 0.3] * 12 + [0.1]), lambda x: x)
    mean = (12 * 0.3 + 13 * 0.1) / 25
    assert mean_slip(fit) == pytest.approx(mean, rel=1e-14)
    assert slip_variance(fit) == pytest.approx(
        (12 * (0.3 - mean) ** 2 + 13 * (0.1 - mean) ** 2) / 25, rel=1e-12
    )


def test_samples_that_do_not_differ_have_no_curve():
    fit = fitted(np.full(60, 0.05), lambda x: 0.3)
    assert fitted_curve(fit) == FittedCurve(0.0, 0.0)
    assert fitted_peak(DEFAULT, fit) == math.inf


@pytest.mark.parametrize(("a", "b", "peak"), [(1.0, 2.0, math.inf), (-1.0, -2.0, 0.0)])
def test_curves_that_only_rise_or_only_fall(a, b, peak):
    fit = fitted(np.linspace(0.01, 0.12, 25), lambda x: a * x + b * math.sqrt(x + OFFSET))
    assert fitted_peak(DEFAULT, fit) == peak


OFF = {  # the template is not Burckhardt's curve, so it errs by the surface
    "packed_snow_1": -0.051,
    "packed_snow_2": -0.141,
    "wet_asphalt_1": -0.021,
    "wet_asphalt_2": -0.034,
    "dry_asphalt": 0.141,
}


@pytest.mark.parametrize("surface", OFF)
def test_the_fit_finds_burckhardts_peak(surface):
    """A window that ends at 1.1 S* and begins at a third of that, without noise.

    Within the rounding of `OFF`.
    """
    of = SURFACES[surface]
    star = math.log(of.c1 * of.c2 / of.c3) / of.c2
    fit = fitted(
        np.linspace(1.1 * star / 3, 1.1 * star, 25),
        lambda x: of.c1 * (1 - math.exp(-of.c2 * x)) - of.c3 * x,
    )
    assert fitted_peak(DEFAULT, fit) / star - 1.0 == pytest.approx(OFF[surface], abs=0.0005)


def test_template_of_the_patent_fits_its_own_curve():
    """4 x - 20 x^2 has its peak at -A/(2 B) = 0.1, where its slope is zero, and no error."""
    patent, fit = SlipCurveParameters(template=Template.SQUARE, largest_error=1e-12), SlipCurveFit()
    for n in range(60):
        x = 0.002 * n
        add_sample(fit, SIZE, OFFSET, x, 4.0 * x - 20.0 * x * x, Template.SQUARE)
    numbers = numbers_of(patent)
    assert fitted_curve(fit) == pytest.approx((4.0, -20.0), rel=1e-9)
    assert fitted_peak(numbers, fit) == pytest.approx(0.1, rel=1e-9)
    assert slope(fit, fitted_curve(fit), 0.1) == pytest.approx(0.0, abs=1e-9)


def test_a_fit_with_too_large_an_error_has_no_peak():
    """Residuals of +-0.01 in 25 samples.

    F = 25 * 1e-4 = 0.0025, more than the 0.001 of the source, less than 0.005.
    """
    fit = SlipCurveFit()
    for n in range(25):
        x = 0.02 + 0.004 * n
        add_sample(fit, SIZE, OFFSET, x, 2.0 * math.sqrt(x) - 4.0 * x + (0.01 if n % 2 else -0.01))
    strict, loose = (
        numbers_of(SlipCurveParameters(largest_error=bound)) for bound in (0.001, 0.005)
    )
    assert fitted_peak(strict, fit) == math.inf
    assert fitted_peak(loose, fit) == pytest.approx(1 / 16, abs=0.01)
