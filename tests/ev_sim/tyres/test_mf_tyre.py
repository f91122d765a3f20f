"""The Magic Formula with load dependence: forces, its file, and what is refused."""

from __future__ import annotations

import csv
import math
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ev_core.vehicle.files import mf_numbers, read_tyre
from ev_core.vehicle.tyre import MF_NAMES, Tyre, mf_tyres
from ev_msgs_py.refusal import ParameterError
from ev_sim.surfaces import SURFACES, curve_on_road, tyre_on_road
from ev_sim.tyres.contact_patch import weighted
from ev_sim.tyres.mf_tyre import MfTyre, at_load, cornering_stiffness, forces, is_plain
from ev_study.measured.magic_formula import Points, lateral, longitudinal

FILE = "tyres/pacejka_2006_205_60r15.tir"
NUMBERS = read_tyre("vehicle.tyre.front_file", FILE)
TYRES = mf_tyres(NUMBERS, NUMBERS)
FRONT_LEFT = MfTyre(TYRES, 0, True)
FRONT = {name: getattr(TYRES, name)[0] for name in MF_NAMES}
DRY = tyre_on_road(
    Tyre(curve="mf_tyre", combined="weighted", front_mf=NUMBERS, rear_mf=NUMBERS), "dry_asphalt"
)
ENTRIES = {name.upper(): repr(value) for name, value in zip(MF_NAMES, NUMBERS, strict=True)} | {
    "FITTYP": "61"
}

with (Path(__file__).parent / "mf_tyre_forces.csv").open() as file:
    REFERENCE = [
        {k: float(v) for k, v in row.items()}
        for row in csv.DictReader(r for r in file if r[0] != "#")
    ]


def forces_at(tyres, load, slip_ratio, slip_angle, plain):
    """Sizes of both forces [N] of the front left tyre at signed slips."""
    tyre = MfTyre(tyres, 0, plain)
    loaded = at_load(tyre, load, 1.0, 1.0)
    return forces(
        tyre, loaded, abs(slip_ratio), math.tan(slip_angle), math.copysign(1.0, slip_ratio)
    )


def test_forces_are_those_of_an_independent_implementation():
    """Forces agree to 1e-12, by the short formula and the full one (measured 2.8e-15)."""
    for row in REFERENCE:
        expected = abs(row["longitudinal_force"]), abs(row["side_force"])
        for plain in (True, False):
            found = forces_at(TYRES, row["load"], row["slip_ratio"], row["slip_angle"], plain)
            assert found == pytest.approx(expected, rel=1e-12, abs=1e-9)


def test_tyres_with_all_terms_follow_the_printed_formula():
    """Curved weights, an angle in place of its tangent, P_Ky4 of its own.

    Pacejka's equations with the C library.
    """
    numbers = dict(FRONT) | {"rex1": 0.3, "rex2": -0.2, "rey1": -0.6, "rey2": 0.4, "rhy2": 0.01}
    numbers |= {"pky4": 1.8, "pex4": 0.2, "takes_tangent": 0.0}
    tyres = mf_tyres(tuple(numbers.values()), tuple(numbers.values()))
    assert not is_plain(tyres) and is_plain(TYRES)
    for load, slip_ratio, angle in ((2000.0, 0.05, 0.1), (4000.0, -0.12, 0.03), (7000.0, 0.4, 0.3)):
        expected = printed_formula(load / 4000.0 - 1.0, load, slip_ratio, angle, **numbers)
        assert forces_at(tyres, load, slip_ratio, angle, False) == pytest.approx(
            expected, rel=1e-12
        )


def printed_formula(df, load, kappa, alpha, **n):
    """Pacejka 2012, eqs 4.E9 to 4.E65 with the terms of `MfTyres`, forces as sizes [N]."""

    def bent(x, curvature):
        return math.atan(x - curvature * (x - math.atan(x)))

    peak_x, peak_y = (n["pdx1"] + n["pdx2"] * df) * load, (n["pdy1"] + n["pdy2"] * df) * load
    stiffness_x = load * (n["pkx1"] + n["pkx2"] * df) * math.exp(n["pkx3"] * df)
    stiffness_y = (
        n["pky1"] * n["fnomin"] * math.sin(n["pky4"] * math.atan(load / (n["pky2"] * n["fnomin"])))
    )
    curved_x = (n["pex1"] + n["pex2"] * df + n["pex3"] * df * df) * (
        1.0 - n["pex4"] * math.copysign(1.0, kappa)
    )
    curved_y = n["pey1"] + n["pey2"] * df
    pure_x = peak_x * math.sin(
        n["pcx1"] * bent(stiffness_x / (n["pcx1"] * peak_x) * kappa, curved_x)
    )
    pure_y = peak_y * math.sin(
        n["pcy1"] * bent(stiffness_y / (n["pcy1"] * peak_y) * alpha, curved_y)
    )
    shift = n["rhy1"] + n["rhy2"] * df
    slope_x = n["rbx1"] * math.cos(math.atan(n["rbx2"] * kappa))
    slope_y = n["rby1"] * math.cos(math.atan(n["rby2"] * alpha))
    curved_x, curved_y = n["rex1"] + n["rex2"] * df, n["rey1"] + n["rey2"] * df
    weight_x = math.cos(n["rcx1"] * bent(slope_x * alpha, curved_x))
    weight_y = math.cos(n["rcy1"] * bent(slope_y * (kappa + shift), curved_y))
    return abs(pure_x * weight_x), pure_y * weight_y / math.cos(
        n["rcy1"] * bent(slope_y * shift, curved_y)
    )


def test_plant_slides_at_the_slips_of_the_formula():
    """The plant's slip velocities over transport velocity give F of kappa and tan(alpha)."""
    along, slip_x, slip_y = 20.0, 0.8, -1.1
    rim = along + slip_x
    loaded = at_load(FRONT_LEFT, 3500.0, 1.0, 1.0)
    of_x, of_y = weighted(FRONT_LEFT, loaded, (slip_x, slip_y), along, rim, (0.0, 0.0))
    expected = forces_at(TYRES, 3500.0, slip_x / along, math.atan(-slip_y / along), True)
    assert (of_x * slip_x / rim, -of_y * slip_y / rim) == pytest.approx(expected, rel=1e-12)
    assert loaded.peak_x > expected[0] and loaded.peak_y > expected[1]


def test_cornering_stiffness_is_degressive():
    """p_Ky1 F_z0 sin(2 atan(F_z/(p_Ky2 F_z0))).

    At its load of 2.13 F_z0 the largest, p_Ky1 F_z0.
    """
    top = FRONT["pky2"] * FRONT["fnomin"]
    assert stiffness(top) == pytest.approx(14.95 * 4000.0, rel=1e-12)
    assert stiffness(0.98 * top) < stiffness(top)
    assert stiffness(2000.0) + stiffness(6000.0) < 2.0 * stiffness(4000.0)


def stiffness(load, on_road=DRY):
    return cornering_stiffness(TYRES, 0, load, on_road.c0, on_road.c1)


def test_snow_scales_friction_and_leaves_slip_stiffness():
    snow = tyre_on_road(
        Tyre(curve="mf_tyre", combined="weighted", front_mf=NUMBERS, rear_mf=NUMBERS),
        "packed_snow_1",
    )
    scale = SURFACES["packed_snow_1"].peak_friction / SURFACES["dry_asphalt"].peak_friction
    assert snow.friction == pytest.approx(scale * FRONT["pdx1"], rel=1e-12)
    assert stiffness(4000.0, snow) == pytest.approx(stiffness(4000.0), rel=1e-12)


def test_shown_curve_is_the_pure_longitudinal_one_at_nominal_load():
    tyre = Tyre(curve="mf_tyre", combined="weighted", front_mf=NUMBERS, rear_mf=NUMBERS)
    shown, peak_slip = curve_on_road(tyre, "wet_asphalt_1")
    loaded = at_load(FRONT_LEFT, FRONT["fnomin"], tyre_on_road(tyre, "wet_asphalt_1").c0, 1.0)
    along, _ = forces(FRONT_LEFT, loaded, 0.07, 1e-6, 1.0)
    assert shown(0.07) * FRONT["fnomin"] == pytest.approx(along, rel=1e-9)
    assert shown(peak_slip) >= max(shown(peak_slip - 0.01), shown(peak_slip + 0.01))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"FITTYP": "70"}, "FITTYP is 70, expected one of 6, 21, 52, 60, 61, 62"),
        ({"ANGLE": "degree"}, "ANGLE is 'degree', expected 'radians'"),
        ({"PKX1": "stiff"}, "PKX1 is 'stiff', expected one finite number"),
        ({"RBX1": None, "PCY1": None}, "lacks PCY1, RBX1"),
        ({"FITTYP": None}, "PROPERTY_FILE_FORMAT is '' without FITTYP"),
    ],
)
def test_a_file_of_another_kind_is_refused(changed, words):
    entries = {key: value for key, value in (ENTRIES | changed).items() if value is not None}
    with pytest.raises(ParameterError, match=words):
        mf_numbers(entries)


def test_a_coefficient_that_is_there_twice_is_refused(tmp_path):
    """Two values in one section or two are refused.

    One value twice is not, nor is MASS of units and inertia.
    """
    lines = [f"{key} = {value} $ comment" for key, value in ENTRIES.items()]
    file = tmp_path / "one.tir"
    file.write_text(
        "\n".join(["[UNITS]", "MASS = 'kg'", "[INERTIA]", "MASS = 9.3", *lines, lines[3]])
    )
    assert read_tyre("vehicle.tyre.front_file", str(file)) == mf_numbers(ENTRIES)
    file.write_text("\n".join([*lines, "[LATERAL]", "PKY1 = 40"]))
    with pytest.raises(ParameterError, match=r"PKY1 is '\S+ and 40', expected one finite number"):
        read_tyre("vehicle.tyre.front_file", str(file))


@pytest.mark.parametrize("pressure", [150e3, 250e3])
def test_another_pressure_than_the_nominal_one_changes_stiffness_and_friction(pressure):
    """Factors are those of the whole formula (eqs 4.E13 to 4.E25), as fitted to rig data."""
    by_pressure = dict(
        zip(
            [f"PP{a}{n}" for a in "XY" for n in range(1, 5)], np.linspace(-0.3, 0.4, 8), strict=True
        )
    )
    entries = (
        ENTRIES | {name: repr(float(v)) for name, v in by_pressure.items()} | {"NOMPRES": "200000"}
    )
    at_nominal = mf_numbers(entries | {"INFLPRES": "200000"})
    assert at_nominal == mf_numbers(entries) == mf_numbers(ENTRIES)
    coefficients = defaultdict(float, {name: float(value) for name, value in entries.items()})
    found = dict(zip(MF_NAMES, mf_numbers(entries | {"INFLPRES": repr(pressure)}), strict=True))
    scaled = coefficients | {name.upper(): value for name, value in found.items()}
    for slip_ratio, angle, load in ((0.05, 0.0, 3000.0), (0.0, 0.1, 5000.0)):
        zero = np.zeros(1)
        at = Points(zero + slip_ratio, zero + angle, zero, zero + load, zero + 200e3, zero, zero)
        whole = replace(at, pressure=zero + pressure)
        for force in (longitudinal, lateral):
            assert force(scaled, at) == pytest.approx(force(coefficients, whole), rel=1e-12)
    with pytest.raises(ParameterError, match="INFLPRES is 0, expected above 0"):
        mf_numbers(entries | {"INFLPRES": "0"})


def test_signs_of_all_axes_give_the_same_tyre():
    """ISO files have P_Dy1 and P_Ky1 below zero, those of Adams P_Ky1 alone."""
    flipped = ENTRIES | {"PDY1": "-0.99", "PDY2": "0.145", "PKY1": "-14.95"}
    assert mf_numbers(flipped) == mf_numbers(
        ENTRIES | {"PDY1": "0.99", "PDY2": "-0.145", "PKY1": "14.95"}
    )


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"combined": "slip_vector"}, "mf_tyre and weighted go together"),
        ({"front_mf": NUMBERS[:-1]}, "needs front_file, or front_mf with"),
        ({"lateral_ratio": 2.0}, "lateral_ratio 1 and load_sensitivity 0"),
        ({"rear_mf": (0.0, *NUMBERS[1:])}, "FNOMIN of the rear tyres is 0, expected above 0"),
        (
            {"front_mf": (4000.0, 3.5, *NUMBERS[2:])},
            "PCX1 of the front tyres is 3.5, expected 0 to 3",
        ),
    ],
)
def test_half_a_tyre_is_refused(changed, words):
    with pytest.raises(ParameterError, match=words):
        Tyre(
            **{"curve": "mf_tyre", "combined": "weighted", "front_mf": NUMBERS, "rear_mf": NUMBERS}
            | changed
        )
