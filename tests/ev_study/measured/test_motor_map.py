"""scripts/run.sh identify --motor.

Losses that made a map come back, and what is no map is refused.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_study.measured.motor_map import fit_motor

LOSSES = {
    "copper_loss": 0.06,
    "iron_loss": 0.4,
    "eddy_loss": 1.5e-3,
    "inverter_loss": 250.0,
    "inverter_torque_loss": 9.0,
}


def write(folder: Path, change: tuple[str, str] = ("", "")) -> Path:
    """A map of a motor with these losses, of which some corners were not measured."""
    lines = ["speed_rpm,torque_nm,efficiency_inverter_to_mechanical"]
    for rpm in np.linspace(500.0, 14000.0, 9):
        for torque in np.linspace(30.0, 300.0, 7):
            speed = rpm * np.pi / 30.0
            loss = sum(
                value * term
                for value, term in zip(
                    LOSSES.values(), (torque**2, speed, speed**2, 1.0, torque), strict=True
                )
            )
            efficiency = speed * torque / (speed * torque + loss)
            lines.append(f"{rpm},{torque},{efficiency:.12g}" if speed * torque < 150e3 else ",,")
    path = folder / "map.csv"
    path.write_text("\n".join(lines).replace(*change) + "\n")
    return path


def test_the_losses_of_a_map_come_back(tmp_path, capsys):
    """They agree to the digits of the file, on unseen points too; the result works as --params."""
    path = write(tmp_path)
    main(["identify", "--motor", str(path), "--out", str(tmp_path / "out")])
    assert "rows left out" in capsys.readouterr().out
    given = ParameterFile(tmp_path / "out" / "motor.yaml").values_for("/ev/plant")
    assert given == pytest.approx(
        {f"vehicle.motor.{name}": value for name, value in LOSSES.items()}, rel=1e-6
    )
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["errors"]["held_out"]["largest"] < 1e-6
    assert (tmp_path / "out" / "error_map.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("torque_nm", "torque"), "unknown column"),
        (("500.0,30.0,", "-500.0,30.0,"), "expected speed and torque"),
    ],
)
def test_what_is_no_map_is_refused(tmp_path, change, message):
    with pytest.raises(ValueError, match=message):
        fit_motor(write(tmp_path, change))


def test_a_row_of_other_units_is_refused_and_one_of_its_own_is_read(tmp_path):
    path = write(tmp_path)
    header, _, rows = path.read_text().partition("\n")
    path.write_text(f"{header}\n1/min,Nm,-\n{rows}")
    assert fit_motor(path).losses == pytest.approx(LOSSES, rel=1e-6)
    path.write_text(f"{header}\nrad/s,Nm,-\n{rows}")
    with pytest.raises(ValueError, match=r"map\.csv: speed_rpm is in 'rad/s', expected rpm"):
        fit_motor(path)


@pytest.mark.parametrize(("column", "name"), [(0, "speed_rpm"), (1, "torque_nm")])
def test_a_map_at_one_speed_or_torque_is_refused(tmp_path, column, name):
    """A loss by the square of the speed would take the constant ones, for all speeds."""
    path = write(tmp_path)
    header, *lines = path.read_text().splitlines()
    rows = np.array([list(map(float, line.split(","))) for line in lines if line != ",,"])
    rows[:, column] = rows[:, column].mean() * np.linspace(0.8, 1.2, len(rows))
    text = [header, *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(text))
    with pytest.raises(
        ParameterError, match=f"{name} is .* to .*, expected 2 times as much as the"
    ):
        fit_motor(path)
