"""The speed cycles of config/cycles, read as the driver reads them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file

MILE = 1.609344  # km
CYCLES = Path(__file__).parents[3] / "config" / "cycles"


def points(name: str) -> list[tuple[float, float]]:
    profile = with_profile_from_file(SpeedProfileParameters(file=f"cycles/{name}.csv"))
    return list(zip(profile.time, profile.speed, strict=True))


@pytest.mark.parametrize(
    ("name", "duration", "distance", "tolerance"),
    [
        ("trrl_1_1", 580.0, 4402.6, 0.05),  # printed to 0.1 m
        ("ece_15", 195.0, 1013.0, 2.0),  # Regulation 83; its tables are rounded
        ("nedc", 1180.0, 11007.0, 11.0),  # Regulation 83; within 0.1 %
        ("wltc_class_3b", 1800.0, 23266.0, 1.0),  # GTR 15
    ],
)
def test_duration_and_distance(name, duration, distance, tolerance):
    rows = points(name)
    driven = sum((v0 + v1) / 2 * (t1 - t0) for (t0, v0), (t1, v1) in pairwise(rows))
    assert rows[-1][0] - rows[0][0] == duration
    assert driven == pytest.approx(distance, abs=tolerance)
    assert rows[0][1] == rows[-1][1] == 0.0


@pytest.mark.parametrize(
    ("name", "seconds", "miles", "fastest"),
    [("udds", 1369, 7.45, 56.7), ("hwfet", 765, 10.26, 59.9), ("nycc", 598, 1.18, 27.7)],
)
def test_schedules_of_the_epa(name, seconds, miles, fastest):
    """Duration, distance to the printed 0.01 mi, speeds in tenths of a mile per hour."""
    rows = points(name)
    assert [t for t, _ in rows] == list(range(seconds + 1))
    tenths = [v * 3.6 / 0.1609344 for _, v in rows]
    rounded = [round(v) for v in tenths]
    # the files have 0.01 km/h
    assert tenths == pytest.approx(rounded, abs=0.005 / 0.1609344 + 1e-9)
    assert max(rounded) / 10 == fastest
    assert rounded[0] == rounded[-1] == 0
    # ends at rest, so the sum is the integral
    assert sum(rounded) / 36000 == pytest.approx(miles, abs=0.005)


@pytest.mark.parametrize(
    ("name", "mean", "digit", "fastest"),
    [
        # km/h; UN Regulation 83, annex 4a: average and maximum speed of part one
        ("ece_15", 19.0, 0.5, 50.0),
        ("nedc", 33.6, 0.05, 120.0),  # the same, parts one and two: 11.007 km in 1180 s
        ("wltc_class_3b", 46.5, 0.05, 131.3),  # UN GTR 15, class 3b, stops included
        ("udds", 19.6 * MILE, 0.05 * MILE, 56.7 * MILE),  # EPA
        ("hwfet", 48.3 * MILE, 0.05 * MILE, 59.9 * MILE),
        ("nycc", 7.1 * MILE, 0.05 * MILE, 27.7 * MILE),
    ],
)
def test_mean_and_top_speed_are_the_printed_ones(name, mean, digit, fastest):
    """Half of the last printed digit."""
    rows = points(name)
    driven = sum((v0 + v1) / 2 * (t1 - t0) for (t0, v0), (t1, v1) in pairwise(rows))
    assert 3.6 * driven / (rows[-1][0] - rows[0][0]) == pytest.approx(mean, abs=digit)
    assert 3.6 * max(v for _, v in rows) == pytest.approx(fastest, abs=0.05)


def test_wltc_checksum_of_the_regulation():
    """GTR 15 prints the sum of the speeds of class 3b: 83758.6 km/h."""
    assert sum(v for _, v in points("wltc_class_3b")) * 3.6 == pytest.approx(83758.6, abs=0.05)


def test_a_cycle_begins_with_its_first_row(tmp_path):
    """Whatever its clock shows there; a grade of zero throughout is none."""
    rows = [(0.0, 0.0), (1.0, 2.0), (3.0, 0.0)]
    for first in (0.0, 3600.0, -5.0):
        path = tmp_path / "cycle.csv"
        path.write_text("t_s,v_mps,grade\n" + "".join(f"{first + t},{v},0\n" for t, v in rows))
        profile = with_profile_from_file(SpeedProfileParameters(file=str(path)))
        assert list(zip(profile.time, profile.speed, strict=True)) == rows
