"""Tyres: the published curves, combined slip, and the carcass."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.tyre import OF_LOAD, Tyre
from ev_sim.plant.planar.planar_state import TyreRecord
from ev_sim.surfaces import SURFACES, tyre_on_road
from ev_sim.tyres.contact_patch import force_and_rate, slip_vector, uncoupled
from ev_sim.tyres.curve import (
    FRICTION_CURVES,
    Coefficients,
    burckhardt,
    dry_friction,
    friction,
    linear,
    magic_formula,
    peak,
    peak_slip,
    rational,
    secant,
    soften,
    two_exponential,
)

TYRES = {
    "rational": (0.8, 0.2, 0.0, 0.0),
    "two_exponential": (0.35, 0.05, 0.15, 0.0),
    "magic_formula": (10.0, 1.6, 0.9, 0.5),
    "linear": (20.0, 0.0, 0.0, 0.0),
    "dry_friction": (1.0, 0.1, 0.7, 0.3),
}
FUNCTIONS = {
    "burckhardt": burckhardt,
    "rational": rational,
    "two_exponential": two_exponential,
    "magic_formula": magic_formula,
    "linear": linear,
    "dry_friction": dry_friction,
}
SIMPLE = [curve for curve in FRICTION_CURVES if curve not in OF_LOAD]


@pytest.mark.parametrize(
    ("surface", "friction", "slip"),
    [("wet_asphalt_1", 0.8013, 0.1308), ("packed_snow_1", 0.4022, 0.0907)],
)
def test_burckhardt_peaks(surface, friction, slip):
    """S* = ln(C1 C2/C3)/C2, dissertation, table 2.3."""
    of = SURFACES[surface]
    assert math.log(of.c1 * of.c2 / of.c3) / of.c2 == pytest.approx(slip, abs=5e-5)
    assert of.peak_friction == pytest.approx(friction, abs=5e-5)
    assert burckhardt(slip, of.c1, of.c2, of.c3, 0.0) == pytest.approx(friction, abs=5e-5)


def test_ice_has_no_peak():
    ice = SURFACES["ice"]
    use = [burckhardt(slip, ice.c1, ice.c2, ice.c3, 0.0) for slip in np.linspace(0, 1, 50)]
    assert all(b >= a for a, b in pairwise(use))


def test_rational_peak():
    """Ge & Ni: mu_p = 0.8 at l_p = 0.2."""
    assert rational(0.2, 0.8, 0.2, 0.0, 0.0) == pytest.approx(0.8)
    assert peak("rational", (0.8, 0.2, 0.0, 0.0)) == pytest.approx(0.8)


def test_two_exponential_full_slip():
    """Zhileykin: mu_s = 0.35 at full slip, S0 = 0.05, S1 = 0.15."""
    assert two_exponential(1.0, 0.35, 0.05, 0.15, 0.0) == pytest.approx(0.35, rel=2e-3)


def test_magic_formula_slope():
    """Slope at the origin B C D."""
    assert magic_formula(1e-6, 10.0, 1.6, 0.9, 0.5) / 1e-6 == pytest.approx(14.4, rel=1e-6)


def test_dry_friction_is_that_of_limit_by_s_triple():
    """PlanarMechanics: y = (3 x - x^3)/2 between -x_max and x_max, then level with y_sat.

    At 60 m/s as at 6 m/s.
    """
    use = [dry_friction(v, 1.0, 0.1, 0.7, 0.3) for v in (0.0, 0.05, 0.1, 0.2, 0.3, 5.0)]
    assert use == pytest.approx([0.0, 0.6875, 1.0, 0.85, 0.7, 0.7], abs=1e-12)
    tyre = namespace(number_tree(Tyre(curve="dry_friction", coefficients=TYRES["dry_friction"])))
    pushed = [
        slip_vector(tyre, on_road("dry_friction", "dry_asphalt"), (0.03, 0.04), speed, (0.0, 0.0))[
            0
        ]
        * 0.05
        / speed
        for speed in (6.0, 60.0)
    ]
    assert pushed == pytest.approx([0.6875] * 2, rel=1e-12)


def on_road(curve: str, surface: str) -> Coefficients:
    return Coefficients(
        *tyre_on_road(Tyre(curve=curve, coefficients=TYRES.get(curve, (0.0,) * 4)), surface)[:4]
    )


@pytest.mark.parametrize("curve", SIMPLE)
def test_secant_is_finite_and_never_negative(curve):
    for surface in SURFACES:
        c = on_road(curve, surface)
        values = [
            secant(FRICTION_CURVES.index(curve), slip, c)
            for slip in (0.0, 1e-12, 1e-3, 0.1, 1.0, 2.0, 3.0)
        ]
        assert all(math.isfinite(value) and value >= 0.0 for value in values)


@pytest.mark.parametrize("curve", SIMPLE)
def test_a_name_leads_to_the_function_of_its_curve(curve):
    """The last branch of `friction` is `linear`: a curve without a branch would be one."""
    c = on_road(curve, "dry_asphalt")
    for slip in (0.0, 0.02, 0.1, 1.0):
        assert friction(FRICTION_CURVES.index(curve), slip, c) == FUNCTIONS[curve](slip, *c)


@pytest.mark.parametrize("curve", SIMPLE)
def test_available_friction_follows_the_road(curve):
    """Friction falls from dry asphalt to ice as the peaks of the surfaces do, whatever the curve."""
    available = {
        name: tyre_on_road(Tyre(curve=curve, coefficients=TYRES.get(curve, (0.0,) * 4)), name)
        for name in ("dry_asphalt", "ice")
    }
    ratio = available["ice"].friction / available["dry_asphalt"].friction
    # Rounding of the products alone: the peak is taken on the same grid.
    assert ratio == pytest.approx(
        SURFACES["ice"].peak_friction / SURFACES["dry_asphalt"].peak_friction, rel=1e-9
    )


@pytest.mark.parametrize("curve", SIMPLE)
def test_a_soft_tyre_has_a_smaller_slope_and_the_same_peak(curve):
    """It gives at a slip what it gave at 0.3 of it."""
    place, c = FRICTION_CURVES.index(curve), on_road(curve, "dry_asphalt")
    tyre = TyreRecord(*c)
    soften(place, tyre, 0.3)
    after = Coefficients(tyre.c0, tyre.c1, tyre.c2, tyre.c3)
    for slip in (0.01, 0.2, 1.0):
        assert friction(place, slip, after) == pytest.approx(
            friction(place, 0.3 * slip, c), rel=1e-12
        )


def test_slip_vector_stays_on_the_friction_circle_and_uncoupled_does_not():
    c = on_road("burckhardt", "dry_asphalt")
    tyre = namespace(number_tree(Tyre()))
    x, y = slip_vector(tyre, c, (1.0, 1.0), 10.0, (0.1, 0.1))
    assert math.hypot(x * 0.1, y * 0.1) == pytest.approx(burckhardt(math.hypot(0.1, 0.1), *c))
    x, y = uncoupled(tyre, c, (1.0, 1.0), (10.0, 10.0), (0.1, 0.1))
    assert x * 0.1 == y * 0.1 == pytest.approx(burckhardt(0.1, *c))


def test_carcass_holds_at_rest_and_reaches_the_curve_at_speed():
    """The force of the spring stays at V = 0; at speed the steady force is secant times slip."""
    force, rate = force_and_rate(0.002, 0.0, 1e-9, 60e3, 350e3, 3500.0)
    assert force == pytest.approx(700.0)
    assert abs(rate) < 1e-10
    deflection = 0.0
    for _ in range(60000):
        force, rate = force_and_rate(deflection, 0.2, 10.0, 60e3, 350e3, 3500.0)
        deflection += 1e-5 * rate
    assert force == pytest.approx(60e3 * 0.2 / 10.0, rel=1e-6)


def test_relaxation_length():
    """The force covers 1 - 1/e of a step of slip within (f + V d)/k of travel."""
    secant_stiffness, stiffness, damping, speed = 60e3, 200e3, 100.0, 2.0
    deflection = distance = 0.0
    while distance < (secant_stiffness + speed * damping) / stiffness:
        _, rate = force_and_rate(deflection, 0.02, speed, secant_stiffness, stiffness, damping)
        deflection += 1e-5 * rate
        distance += 1e-5 * speed
    steady = secant_stiffness * 0.02 / speed / stiffness
    assert deflection / steady == pytest.approx(1.0 - math.exp(-1.0), rel=1e-3)


@pytest.mark.parametrize("curve", SIMPLE)
def test_peak_is_the_highest_of_all_points_of_the_grid(curve):
    """A search through all 10001 of them finds the same, on every surface."""
    for surface in SURFACES:
        c = on_road(curve, surface)
        use = [friction(FRICTION_CURVES.index(curve), n * 1e-4, c) for n in range(10001)]
        assert peak(curve, tuple(c)) == max(use)
        assert peak_slip(curve, tuple(c)) == use.index(max(use)) * 1e-4


@given(
    st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(0.01, 20.0), st.floats(1.1, 10.0), st.floats(1e-3, 50.0),
    st.floats(0.0, 50.0), st.floats(0.1, 10.0),
)  # fmt: skip
def test_dry_friction_is_that_of_its_slip_speed_however_fast(
    adhesion, sliding, rise, beyond, along, across, ratio
):
    """The force is use times load at any speed of its own, of 20 m/s as well.

    The peak is the larger of both levels.
    """
    coefficients = (adhesion, rise, sliding, rise * beyond)
    tyre = Tyre("dry_friction", coefficients, lateral_ratio=ratio)
    on_road = Coefficients(*coefficients)
    record = namespace(number_tree(tyre))
    transport = along + across
    secants = slip_vector(record, on_road, (along, across), transport, (0.0, 0.0))
    use = math.hypot(secants[0] * along, secants[1] * across) / transport
    assert use == pytest.approx(
        dry_friction(math.hypot(along, ratio * across), *coefficients), rel=1e-9
    )
    assert peak("dry_friction", coefficients) == pytest.approx(max(adhesion, sliding), rel=1e-15)
    assert use <= max(adhesion, sliding) * (1.0 + 1e-12)
