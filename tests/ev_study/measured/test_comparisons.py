"""Comparisons with measured data, on files made here.

What holds, what does not, and what is kept of them.
"""

from __future__ import annotations

import csv
import lzma
from pathlib import Path

import numpy as np
import pytest

from ev_stack.commands.run_scenario import main
from ev_study.measured.comparisons.comparison import FILE, declared
from ev_study.measured.comparisons.planar_mechanics import (
    SINGLE_TRACK,
    TWO_TRACK,
    equations_at_end,
    wheel_on_arm,
)

TIME = np.linspace(0.0, 2.0, 1001)
ROOT = Path(__file__).parents[3]


def write(file: Path, columns: dict[str, np.ndarray]) -> None:
    """Write columns as the library does: names in quotes."""
    rows = "\n".join(
        ",".join(f"{x:.12g}" for x in row) for row in np.stack(list(columns.values()), axis=1)
    )
    text = ",".join(f'"{name}"' for name in columns) + "\n" + rows
    file.write_bytes(lzma.compress(text.encode(), preset=0))


def results(folder: Path, angle: np.ndarray, error: float) -> None:
    """Results of the library's equations with a trail; the yaw angles are a share too large."""
    folder.mkdir()
    (one, turned), (other, other_turned) = (
        (p, t.real)
        for p, t in (equations_at_end(car, TIME, angle) for car in (TWO_TRACK, SINGLE_TRACK))
    )
    same = np.ones(len(TIME))
    write(
        folder / "TwoTrackWithDifferentialGear.csv.xz",
        {"Time": TIME, "revolute2.phi": -angle, "body1.r[1]": -one.imag * same, "body1.r[2]": one.real * same}
        | {"body1.phi": turned * (1.0 + error) * same},
    )  # fmt: skip
    ahead = other_turned + angle[-1]
    front = other + np.exp(1j * other_turned) - 0.1 * np.exp(1j * ahead)
    write(
        folder / "SingleTrackWithEngine.csv.xz",
        {"Time": TIME, "revolute.phi": angle, "bodyFront.phi": ahead * same, "bodyFront.r[1]": -front.imag * same}
        | {"bodyFront.r[2]": front.real * same},
    )  # fmt: skip
    for name, of in (
        ("TestDryFrictionWheel", (0.0, 0.0, (0.1, 0.3))),
        ("TestSlipBasedWheel", (0.04, 0.12, (0.05, 0.15))),
    ):
        turned, radius = wheel_on_arm(10.0, *of)
        write(
            folder / f"{name}.csv.xz",
            {"Time": TIME, "body.phi": turned * same, "prismatic.s": radius * same},
        )


def test_a_plant_without_steered_mass_is_that_of_the_equations_without_it(tmp_path, capsys):
    """The plant and Newton-Euler by scipy, with one wheel curve, differ by less than 0.5 %.

    That is in place and yaw. Results with a yaw angle 1 % off do not hold. The reference results
    themselves are not ours to keep.
    """
    results(tmp_path / "planar_mechanics", 0.3 * np.sin(TIME), 0.01)
    out = tmp_path / "out"
    main(["verdicts", "--data", str(tmp_path), "--only", "measured", "--out", str(out)])
    with (out / FILE).open(newline="") as file:
        found = {row["id"]: float(row["value"]) for row in csv.DictReader(file)}
    assert found["two_track_mass_on_axle"] < 0.5
    assert found["single_track_mass_on_axle"] < 0.5
    assert found["two_track_equations"] == pytest.approx(100 * 0.01 / 1.01, rel=0.01)
    assert found["single_track_equations"] < 1e-3
    assert found["TestSlipBasedWheel"] < 1e-3
    shown = capsys.readouterr().out
    assert "does not hold" in shown
    assert "reproduced" not in shown  # no paper was driven


def test_a_folder_without_data_is_refused(tmp_path):
    with pytest.raises(SystemExit, match="has no measured data"):
        main(
            [
                "verdicts",
                "--data",
                str(tmp_path),
                "--only",
                "measured",
                "--out",
                str(tmp_path / "out"),
            ]
        )


def test_every_comparison_that_is_declared_is_kept():
    with (ROOT / "docs" / "measured" / "comparisons.csv").open(newline="") as file:
        kept = [row["id"] for row in csv.DictReader(file)]
    assert kept == [each.id for each in declared()]
