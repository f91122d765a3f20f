"""The Magic Formula with load dependence: forces, its file, and what is refused."""

from __future__ import annotations

import csv
import dataclasses
import math
from pathlib import Path

import pytest

from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.vehicle.mf_tyre import MF_NAMES, MfTyre
from ev_msgs_py.vehicle.tyre import Tyre
from ev_msgs_py.vehicle.tyre_property_file import mf_numbers, read_tyre
from ev_sim.surfaces.table import SURFACES, curve_on_road, tyre_on_road
from ev_sim.tyres import magic_formula
from ev_sim.tyres.mf_tyre import at_load, cornering_stiffness, forces
from ev_sim.tyres.weighted import weighted

FILE = "tyres/pacejka_2006_205_60r15.tir"
NUMBERS = read_tyre("vehicle.tyre.front_file", FILE)
TYRE = MfTyre(*NUMBERS)
DRY = tyre_on_road(Tyre(curve="mf_tyre", combined="weighted", front_mf=NUMBERS, rear_mf=NUMBERS), "dry_asphalt")
ENTRIES = {name.upper(): repr(value) for name, value in zip(MF_NAMES, NUMBERS, strict=True)} | {"FITTYP": "61"}

with (Path(__file__).parent / "mf_tyre_forces.csv").open() as file:
    REFERENCE = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(r for r in file if r[0] != "#")]


def test_forces_are_those_of_an_independent_implementation():
    """To 1e-12 of each: both add up the same terms in another order (measured 2.3e-15)."""
    for row in REFERENCE:
        loaded = at_load(TYRE, row["load"], 1.0, 1.0)
        tangent, drives = math.tan(row["slip_angle"]), row["slip_ratio"] > 0.0
        along, across = forces(TYRE, loaded, abs(row["slip_ratio"]), tangent, drives)
        assert along == pytest.approx(abs(row["longitudinal_force"]), rel=1e-12, abs=1e-9)
        assert across == pytest.approx(abs(row["side_force"]), rel=1e-12, abs=1e-9)


def test_older_files_take_the_angle_itself():
    older = dataclasses.replace(TYRE, takes_tangent=0.0)
    loaded = at_load(TYRE, 4000.0, 1.0, 1.0)
    angle = 0.15
    assert forces(older, loaded, 1e-6, math.tan(angle), True) == pytest.approx(
        forces(TYRE, loaded, 1e-6, angle, True), rel=1e-9
    )


def test_plant_slides_at_the_slips_of_the_formula():
    """Slip velocities over the transport velocity, as the plant has them, give F of kappa and tan(alpha)."""
    along, slip_x, slip_y = 20.0, 0.8, -1.1
    rim = along + slip_x
    of_x, of_y, peak_x, peak_y = weighted(TYRE, DRY, 3500.0, slip_x, slip_y, along, rim, 0.0, 0.0)
    expected = forces(TYRE, at_load(TYRE, 3500.0, 1.0, 1.0), slip_x / along, -slip_y / along, True)
    assert (of_x * slip_x / rim, -of_y * slip_y / rim) == pytest.approx(expected, rel=1e-12)
    assert peak_x > expected[0] and peak_y > expected[1]


def test_cornering_stiffness_is_degressive():
    """p_Ky1 F_z0 sin(2 atan(F_z/(p_Ky2 F_z0))): at its load of 2.13 F_z0 the largest, p_Ky1 F_z0."""
    top = TYRE.pky2 * TYRE.fnomin
    assert cornering_stiffness(TYRE, top, DRY) == pytest.approx(14.95 * 4000.0, rel=1e-12)
    assert cornering_stiffness(TYRE, 0.98 * top, DRY) < cornering_stiffness(TYRE, top, DRY)
    pair = cornering_stiffness(TYRE, 2000.0, DRY) + cornering_stiffness(TYRE, 6000.0, DRY)
    assert pair < 2.0 * cornering_stiffness(TYRE, 4000.0, DRY)


def test_snow_scales_friction_and_leaves_slip_stiffness():
    snow = tyre_on_road(Tyre(curve="mf_tyre", combined="weighted", front_mf=NUMBERS, rear_mf=NUMBERS), "packed_snow_1")
    scale = SURFACES["packed_snow_1"].peak_friction / SURFACES["dry_asphalt"].peak_friction
    assert snow.friction == pytest.approx(scale * TYRE.pdx1, rel=1e-12)
    assert cornering_stiffness(TYRE, 4000.0, snow) == pytest.approx(cornering_stiffness(TYRE, 4000.0, DRY), rel=1e-12)


def test_shown_curve_is_the_pure_longitudinal_one_at_nominal_load():
    tyre = Tyre(curve="mf_tyre", combined="weighted", front_mf=NUMBERS, rear_mf=NUMBERS)
    kind, c = curve_on_road(tyre, "wet_asphalt_1")
    assert kind == "magic_formula"
    loaded = at_load(TYRE, TYRE.fnomin, tyre_on_road(tyre, "wet_asphalt_1").c0, 1.0)
    along, _ = forces(TYRE, loaded, 0.07, 1e-6, True)
    assert magic_formula.friction(0.07, *c) * TYRE.fnomin == pytest.approx(along, rel=1e-9)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"FITTYP": "70"}, "FITTYP is 70, allowed is one of 6, 21, 52, 60, 61, 62"),
        ({"ANGLE": "degree"}, "ANGLE is 'degree', allowed is 'radians'"),
        ({"PKX1": "stiff"}, "PKX1 is 'stiff', allowed is a finite number"),
        ({"RBX1": None, "PCY1": None}, "lacks PCY1, RBX1"),
        ({"FITTYP": None}, "PROPERTY_FILE_FORMAT is '' without FITTYP"),
    ],
)
def test_a_file_of_another_kind_is_refused(changed, words):
    entries = {key: value for key, value in (ENTRIES | changed).items() if value is not None}
    with pytest.raises(ParameterError, match=words):
        mf_numbers(entries)


def test_signs_of_all_axes_give_the_same_tyre():
    """ISO files have P_Dy1 and P_Ky1 below zero, those of Adams P_Ky1 alone."""
    flipped = ENTRIES | {"PDY1": "-0.99", "PDY2": "0.145", "PKY1": "-14.95"}
    assert mf_numbers(flipped) == mf_numbers(ENTRIES | {"PDY1": "0.99", "PDY2": "-0.145", "PKY1": "14.95"})


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"combined": "slip_vector"}, "mf_tyre and weighted go together"),
        ({"front_mf": NUMBERS[:-1]}, "needs front_file, or front_mf with"),
        ({"lateral_ratio": 2.0}, "lateral_ratio 1 and load_sensitivity 0"),
        ({"rear_mf": (0.0, *NUMBERS[1:])}, "FNOMIN of the rear tyres is 0, allowed is above 0"),
    ],
)
def test_half_a_tyre_is_refused(changed, words):
    with pytest.raises(ParameterError, match=words):
        Tyre(**{"curve": "mf_tyre", "combined": "weighted", "front_mf": NUMBERS, "rear_mf": NUMBERS} | changed)
