"""TMeasy: its curves at a load, combined slip, files, and tyres estimated from their size."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import ev_stack
from ev_core.vehicle.files import read_tyre, tmeasy_numbers
from ev_core.vehicle.tmeasy import (
    LARGEST_LOAD,
    TMEASY_NAMES,
    estimated_tmeasy,
    tmeasy_tyre,
    tyre_size,
)
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.planar_state import TyreRecord
from ev_sim.surfaces import SURFACES, curve_on_road, tyre_on_road
from ev_sim.tyres.contact_patch import normalized
from ev_sim.tyres.curve import TMEASY, soften
from ev_sim.tyres.tmeasy import at_load, cornering_stiffness, over_slip, towards

# Sedan/tmeasy.json of uwsbel/low-fidelity-dynamic-models (MIT), in the order of TMEASY_NAMES.
SEDAN = (
    8562.8266,
    *(142057.4736, 221755.19702, 0.12, 0.15, 7575.3614, 12808.276),
    *(0.9, 0.95, 4657.9208, 8625.3352),
    *(56024.8623, 103723.224, 0.38786, 0.38786, 6615.0404, 12509.947),
    *(0.82534, 0.91309, 6091.5092, 11443.875),
)
ENTRIES = {name.upper(): repr(value) for name, value in zip(TMEASY_NAMES, SEDAN, strict=True)} | {
    "PROPERTY_FILE_FORMAT": "TMEASY"
}
SIZE = "205/60R15 91V"
CHOSEN = {"curve": "tmeasy", "combined": "normalized"}
ESTIMATED = Tyre(**CHOSEN, estimated_from=SIZE)

with (Path(__file__).parent / "tmeasy_forces.csv").open() as file:
    REFERENCE = [
        {k: float(v) for k, v in row.items()}
        for row in csv.DictReader(r for r in file if r[0] != "#")
    ]


def forces(numbers, load, slip_x, slip_y, grip=1.0):
    """Longitudinal and side force [N] at slips over the speed of the rim."""
    of = at_load(tmeasy_tyre(numbers), load, grip, 1.0)
    x, y = slip_x / of.along_of, slip_y / of.across_of
    resulting = max(math.hypot(x, y), 1e-9)
    common = load * over_slip(towards(of, abs(x) / resulting, abs(y) / resulting), resulting)
    return common * x, common * y


@st.composite
def tyres(draw):
    """Numbers of any tyre that is accepted."""
    load = draw(st.floats(500.0, 20e3))
    numbers = [load]
    for _ in "xy":
        peak_slip = draw(st.floats(0.02, 0.4))
        full_slip = peak_slip * draw(st.floats(1.2, 10.0))
        grown = draw(st.floats(0.7, 1.4))
        peak = load * draw(st.floats(0.1, 1.5))
        peaks = (peak, peak * draw(st.floats(1.1, 3.0)))
        slips = (peak_slip, grown * peak_slip)
        slopes = [
            2.0 * f / s * draw(st.floats(1.0, 1.3)) for f, s in zip(peaks, slips, strict=True)
        ]
        sliding = draw(st.floats(0.3, 1.0))
        numbers += [*slopes, *slips, *peaks, full_slip, grown * full_slip]
        numbers += [sliding * force for force in peaks]
    try:
        Tyre(**CHOSEN, front_tmeasy=tuple(numbers), rear_tmeasy=tuple(numbers))
    except ParameterError:
        # A slope may lie outside its range at one load, when peak and slip change against each
        # other.
        numbers = list(SEDAN)
    return tuple(numbers)


def test_forces_are_those_of_an_independent_implementation():
    """Forces agree to 1e-12 at five loads, 0.18 to 2.57 times the nominal one, in all directions."""
    for row in REFERENCE:
        expected = row["longitudinal_force"], row["side_force"]
        found = forces(SEDAN, row["load"], row["slip_x"], row["slip_y"])
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-6)


@pytest.mark.parametrize(("factor", "load"), [(0, "pn"), (1, "p2n")])
def test_curves_pass_through_the_printed_numbers(factor, load):
    """Each force has, at P_N and 2 P_N, its slope, its peak at s_M and its sliding force from s_S."""
    of = dict(zip(TMEASY_NAMES, SEDAN, strict=True))
    vertical = of["pn"] * (1 + factor)
    for axis, chosen in (("x", 0), ("y", 1)):

        def force(slip, chosen=chosen):
            slips = (slip, 0.0) if chosen == 0 else (0.0, slip)
            return forces(SEDAN, vertical, *slips)[chosen]

        assert force(1e-7) / 1e-7 == pytest.approx(of[f"df{axis}0_{load}"], rel=1e-5)
        peak_slip = of[f"s{axis}m_{load}"]
        assert force(peak_slip) == pytest.approx(of[f"f{axis}m_{load}"], rel=1e-12)
        assert force(peak_slip) > max(force(0.99 * peak_slip), force(1.01 * peak_slip))
        for slip in (1.0, 1.5, 30.0):
            at = slip * of[f"s{axis}s_{load}"]
            assert force(at) == pytest.approx(of[f"f{axis}s_{load}"], rel=1e-12)


@given(tyres(), st.floats(0.0, 4.0), st.floats(0.0, math.pi / 2), st.floats(0.05, 1.0))
def test_any_accepted_tyre_has_one_peak_and_no_step(numbers, share, direction, grip):
    """The curve rises to F_M and falls to F_S at any load, in any direction, on any road."""
    of = at_load(tmeasy_tyre(numbers), share * numbers[0], grip, 1.0)
    c = towards(of, math.cos(direction), math.sin(direction))
    slips = [c.full_slip * n / 300 for n in range(1, 330)]
    use = [slip * over_slip(c, slip) for slip in slips]
    # Rounding of the parabolas alone.
    small = 1e-12 * c.peak
    for slip, before, after in zip(slips, use, use[1:], strict=False):
        if slip < c.peak_slip - c.full_slip / 300:
            assert after >= before - small
        elif slip > c.peak_slip:
            assert after <= before + small
    assert max(use) <= c.peak + small
    assert min(use[300:]) == pytest.approx(c.sliding, rel=1e-12)
    for joint in (c.peak_slip, c.full_slip):
        below, above = joint * (1.0 - 1e-9), joint * (1.0 + 1e-9)
        steepest = max(c.slope, 2.0 * c.peak / c.peak_slip)
        gap = abs(above * over_slip(c, above) - below * over_slip(c, below))
        # Parts meet: between both the force moves by no more than its slope makes it.
        assert gap <= 1e-8 * joint * steepest


@given(tyres(), st.floats(0.0, LARGEST_LOAD))
def test_forces_are_parabolas_of_the_load_and_slips_are_lines(numbers, share):
    """F = q (2 F_1 - F_2/2 - (F_1 - F_2/2) q) and s = s_1 + (s_2 - s_1) (q - 1), q = F_z/P_N."""
    of = dict(zip(TMEASY_NAMES, numbers, strict=True))
    load = share * of["pn"]
    along = at_load(tmeasy_tyre(numbers), load, 1.0, 1.0).along
    once, twice = of["fxm_pn"], of["fxm_p2n"]
    parabola = share * (2.0 * once - 0.5 * twice - (once - 0.5 * twice) * share)
    assert load * along.peak == pytest.approx(parabola, rel=1e-9, abs=1e-9)
    line = of["sxm_pn"] + (of["sxm_p2n"] - of["sxm_pn"]) * (share - 1.0)
    assert along.peak_slip == pytest.approx(line, rel=1e-9)


@pytest.mark.parametrize("surface", ["ice", "packed_snow_1"])
def test_a_slippery_road_scales_peaks_and_their_slips_and_keeps_the_slope(surface):
    """F_M, F_S, s_M and s_S are in proportion to the friction, dF_0 is not (Rill: mu_L/mu_0)."""
    scale = SURFACES[surface].peak_friction / SURFACES["dry_asphalt"].peak_friction
    front = tmeasy_tyre(ESTIMATED.numbers("front"))
    found = tyre_on_road(ESTIMATED, surface)
    assert found.friction == pytest.approx(scale * 1.1292, rel=1e-12)
    dry, slippery = (at_load(front, 3000.0, grip, 1.0).across for grip in (1.0, found.c0))
    assert slippery.slope == dry.slope
    for name in ("peak", "sliding", "peak_slip", "full_slip"):
        assert getattr(slippery, name) == pytest.approx(scale * getattr(dry, name), rel=1e-12)


def test_a_soft_tyre_gives_at_a_slip_what_it_gave_at_a_share_of_it():
    front = tmeasy_tyre(SEDAN)
    on_road = TyreRecord(0.7, 1.0)
    sound = at_load(front, 6000.0, on_road.c0, on_road.c1).along
    soften(TMEASY, on_road, 0.3)
    soft = at_load(front, 6000.0, on_road.c0, on_road.c1).along
    assert soft.peak == sound.peak
    for slip in (0.01, 0.2, 1.0, 5.0):
        expected = 0.3 * slip * over_slip(sound, 0.3 * slip)
        assert slip * over_slip(soft, slip) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("rim", "slip"), [(20.8, (0.8, -1.1)), (19.2, (-0.8, 0.4)), (8.0, (-12.0, 3.0))]
)
def test_plant_slides_at_the_slips_of_the_formula(rim, slip):
    """Slip velocities give the forces of slips over the speed of the rim; driving and braking."""
    of = at_load(tmeasy_tyre(SEDAN), 5000.0, 1.0, 1.0)
    transport = max(rim, math.hypot(rim - slip[0], slip[1]))
    # A contact that slides already, so all of the slip counts.
    secants = normalized(of, slip, rim, transport, (10.0, 10.0))
    expected = forces(SEDAN, 5000.0, slip[0] / rim, slip[1] / rim)
    found = [5000.0 * of_slip * v / transport for of_slip, v in zip(secants, slip, strict=True)]
    assert found == pytest.approx(expected, rel=1e-12)


@given(
    tyres(), st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(-60.0, 60.0),
    st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(0.0, 4.0), st.floats(0.05, 1.0),
)  # fmt: skip
def test_friction_is_finite_and_opposes_at_any_motion(
    numbers, rim, slip_x, slip_y, contact_x, contact_y, share, grip
):
    """Also at rest, on a wheel that spins on the spot, sliding sideways, with any load."""
    of = at_load(tmeasy_tyre(numbers), share * numbers[0], grip, 1.0)
    transport = max(abs(rim), math.hypot(rim - slip_x, slip_y), 1e-9)
    secants = normalized(of, (slip_x, slip_y), rim, transport, (contact_x, contact_y))
    # TMeasy's peak of a mixed slip is that of both directions by their shares, and the force has the
    # direction of the normalized slips. So its component may be beyond the peak of one direction.
    x, y = slip_x / of.along_of, slip_y / of.across_of
    resulting = math.hypot(x, y)
    for secant, normal, slid in zip(secants, (x, y), (slip_x, slip_y), strict=True):
        assert math.isfinite(secant) and secant >= 0.0
        # Where all of the slip counts.
        if max(abs(contact_x), abs(contact_y)) > 2.0 and resulting > 0.0:
            peak = math.hypot(of.along.peak * x, of.across.peak * y) / resulting
            most = peak * abs(normal) / resulting
            assert secant * abs(slid) / transport <= most * (1.0 + 1e-9) + 1e-9


def test_cornering_stiffness_is_degressive():
    """The lateral slope: at P_N and 2 P_N as printed, and less than in proportion to the load."""
    front = tmeasy_tyre(SEDAN)
    once, twice = (cornering_stiffness(front, n * SEDAN[0], 1.0, 1.0) for n in (1, 2))
    assert (once, twice) == pytest.approx((56024.8623, 103723.224), rel=1e-12)
    assert twice < 2.0 * once


def test_shown_curve_is_the_longitudinal_one_at_nominal_load():
    numbers = ESTIMATED.numbers("front")
    shown, peak_slip = curve_on_road(ESTIMATED, "dry_asphalt")
    assert peak_slip == numbers[TMEASY_NAMES.index("sxm_pn")]
    assert shown(peak_slip) == pytest.approx(1.1292, rel=1e-12)
    assert shown(0.05) * numbers[0] == pytest.approx(forces(numbers, numbers[0], 0.05, 0.0)[0])
    assert shown(0.0) == 0.0


# Files and numbers


def test_file_gives_the_numbers_by_name(tmp_path):
    file = tmp_path / "sedan.tir"
    lines = [f"{key} = {value}" for key, value in ENTRIES.items()]
    file.write_text("\n".join(["[UNITS]", "FORCE = 'newton'", *reversed(lines)]))
    read = read_tyre("vehicle.tyre.front_file", str(file), tmeasy_numbers)
    assert read == SEDAN


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"PROPERTY_FILE_FORMAT": "PAC2002"}, "PROPERTY_FILE_FORMAT is 'PAC2002', expected 'TME"),
        ({"FORCE": "pound"}, "FORCE is 'pound', expected 'newton'"),
        ({"FXM_PN": None, "SYS_P2N": None}, "lacks FXM_PN, SYS_P2N"),
        ({"FXM_PN": "nan"}, "FXM_PN is 'nan', expected one finite number"),
    ],
)
def test_a_file_of_another_kind_is_refused(changed, words):
    entries = {key: value for key, value in (ENTRIES | changed).items() if value is not None}
    with pytest.raises(ParameterError, match=words):
        tmeasy_numbers(entries)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"pn": 0.0}, "PN of the front tyres is 0, expected above 0"),
        ({"fxm_p2n": 7000.0}, "FXM_P2N of the front tyres is 7000, expected above 7575.36 and"),
        ({"dfy0_pn": 30000.0}, "DFY0_PN of the front tyres is 30000, expected 2 F_M/s_M or more"),
        (
            {"fys_p2n": 13000.0},
            "FYS_P2N of the front tyres is 13000, expected at most F_M, 12509.9",
        ),
        ({"sxm_p2n": 0.3}, "slips that give 0 < s_M < s_S at 0 times the nominal load"),
        ({"sys_p2n": 0.4}, "slips that give 0 < s_M < s_S at 3 times the nominal load"),
    ],
)
def test_numbers_without_a_curve_are_refused(changed, words):
    numbers = dict(zip(TMEASY_NAMES, SEDAN, strict=True)) | changed
    with pytest.raises(ParameterError, match=words):
        Tyre(**CHOSEN, front_tmeasy=tuple(numbers.values()), rear_tmeasy=SEDAN)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"combined": "slip_vector"}, "tmeasy and normalized go together"),
        ({"curve": "burckhardt"}, "tmeasy and normalized go together"),
        ({"rear_tmeasy": ()}, "needs rear_file, estimated_from, or rear_tmeasy with 21 elements"),
        ({"load_sensitivity": 0.1}, "lateral_ratio 1 and load_sensitivity 0"),
        ({"estimated_from": SIZE}, "neither files nor numbers of its tyres"),
        (
            {"front_tmeasy": (), "rear_tmeasy": (), "estimated_from": "91V"},
            "estimated_from is '91V'",
        ),
    ],
)
def test_half_a_tyre_is_refused(changed, words):
    with pytest.raises(ParameterError, match=words):
        Tyre(**CHOSEN | {"front_tmeasy": SEDAN, "rear_tmeasy": SEDAN} | changed)


# Estimates


def test_load_indices_are_those_of_the_standard():
    """Loads [kg] of the table of the ETRTO; its numbers are rounded, by up to 1.7 %."""
    table = {60: 250, 71: 345, 80: 450, 91: 615, 100: 800, 110: 1060, 119: 1360, 126: 1700}
    for index, mass in table.items():
        found = tyre_size(f"205/55R16 {index}").largest_load / 9.81
        assert found == pytest.approx(mass, rel=0.02)


def test_estimate_is_the_pattern_of_a_passenger_car_tyre():
    """Numbers at P_N 1900 N are those of the VW bus of Project Chrono (BSD-3-Clause).

    They stand in van_TMeasyTireFull.json, rounded to 1e-4 N.
    """
    of = dict(zip(TMEASY_NAMES, estimated_tmeasy(SIZE), strict=True))
    printed = {
        **{
            "dfx0_pn": 34910.7021,
            "dfx0_p2n": 73974.3082,
            "fxm_pn": 2145.5102,
            "fxm_p2n": 4140.6407,
        },
        **{
            "dfy0_pn": 30366.8749,
            "dfy0_p2n": 48833.5824,
            "fym_pn": 1901.7234,
            "fym_p2n": 3471.9636,
        },
        **{"fxs_pn": 1522.8229, "fxs_p2n": 2922.8487, "fys_pn": 1583.8391, "fys_p2n": 2938.7727},
    }
    for name, force in printed.items():
        # The pattern itself has five or six digits.
        assert of[name] / of["pn"] == pytest.approx(force / 1900.0, rel=1e-4)
    slips = {"sxm_pn": 0.13913, "sxs_p2n": 0.66667, "sym_p2n": 0.18504, "sys_pn": 0.96524}
    assert {name: of[name] for name in slips} == slips
    assert of["pn"] == pytest.approx(0.5 * tyre_size(SIZE).largest_load)


@pytest.mark.parametrize("text", ["205/55R16 91V", "205/55 R 16 91", "205/55ZR16 91w"])
def test_size_is_read_as_written_on_a_side_wall(text):
    size = tyre_size(text)
    assert (size.width, size.aspect, size.load_index) == (0.205, 0.55, 91)
    # 16 inches and two side walls of 112.75 mm, less a third of how far it gives way.
    assert size.rolling_radius == pytest.approx(0.2032 + 0.11275 * (1.0 - 0.08 / 3.0), rel=1e-12)


def estimated_car(**changed):
    """Changes that give compact_ev tyres from their size alone."""
    tyre = {**CHOSEN, "front_file": "", "rear_file": "", "estimated_from": SIZE} | changed
    return {f"*.vehicle.tyre.{name}": value for name, value in tyre.items()}


def test_a_wheel_of_another_size_is_refused():
    with pytest.raises(ParameterError, match=r"wheel_radius is 0.305 m, expected 0.354 m within 5"):
        ev_stack.run(
            "step_steer", vehicle="compact_ev", set=estimated_car(estimated_from="235/55R18 100")
        )


def test_run_on_estimated_tyres_names_the_estimate():
    driven = ev_stack.run(
        "step_steer", vehicle="compact_ev", set=estimated_car(), runs=["left"], duration=0.1
    )
    expected = f"compact_ev: its tyres are an estimate from {SIZE}, by rules of thumb"
    assert expected in driven.summary().notes
