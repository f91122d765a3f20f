"""The rolling sedan beside an 18-DOF and an 11-DOF model of others (docs/measured.md)."""

from __future__ import annotations

from pathlib import Path

import pytest
from plant.planar.beside_18_dof import (
    ACCELERATIONS,
    ANGLES,
    SPEEDS,
    cars,
    gradients,
    reference,
    step,
)

PAGE = Path(__file__).parents[4] / "docs" / "measured.md"
MODELS = ("soft", "front", "rigid", "11dof")
CARS = cars()
THEIRS = reference()


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("model", MODELS)
def test_steps_of_the_steering_angle_agree(model, speed, angle):
    """Gain, sideslip and axle loads within 1 % (found: 0.2 %), rise times within 2 ms (1.8 ms).

    The page has the numbers to their last digit.
    """
    ours, theirs = step(CARS[model], speed, angle), THEIRS[model][f"step {speed:g} {angle:g}"]
    for name in ("gain", "beta", "dfz_f", "dfz_r"):
        if name in theirs:
            assert ours[name] == pytest.approx(theirs[name], rel=0.01), name
    assert ours["t90"] == pytest.approx(theirs["t90"], abs=2e-3)
    (row,) = (line for line in page_rows(model) if line[1] == f"{speed:g} m/s, {angle:g} rad")
    printed = [float(cell.split(" / ")[0]) for cell in row[2:5]]
    # Half of a digit and a bit: another processor may round another way.
    assert printed[0] == pytest.approx(ours["gain"], abs=0.6e-4)
    assert printed[1] == pytest.approx(1e3 * ours["beta"], abs=0.6e-3)
    assert printed[2] == pytest.approx(1e3 * ours["t90"], abs=0.06)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_understeer_gradients_agree(model):
    """The gradient of a slow ramp at 2, 4 and 6 m/s^2, within 1.5 % or 4 urad s^2/m.

    A gradient is a small difference of slip angles: 3 urad s^2/m are 0.03 % of the yaw rate gain,
    by which the rigid car is off as well, and 1 to 4 % of the gradient at 2 m/s^2. At 6 m/s^2 the
    slope rises fivefold within 2 m/s^2, and the width of their fit is not known.
    """
    ours, theirs = gradients(CARS[model]), THEIRS[model]["ramp 20"]
    (row,) = (line for line in page_rows(model) if len(line) == 4)
    for n, name in enumerate(ACCELERATIONS):
        assert ours[name] == pytest.approx(theirs[name], rel=0.015, abs=4e-6), name
        assert float(row[n + 1].split(" / ")[0]) == pytest.approx(1e3 * ours[name], rel=1e-3)


def page_rows(model: str) -> list[list[str]]:
    """Cells of the rows that docs/measured.md has of a model."""
    lines = [line for line in PAGE.read_text().splitlines() if line.startswith(f"| {model} |")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
