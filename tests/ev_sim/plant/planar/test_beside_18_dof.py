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
    sine,
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


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("model", MODELS)
def test_sines_of_the_steering_angle_agree(model, speed):
    """Yaw rate and lateral acceleration within 0.2 % and 0.2 deg (found: 0.12 %, 0.16 deg).

    Sideslip at 15 m/s is the small rest of two velocities: 1.3 mrad/rad are 1 % of it and up to
    1.6 % of that of a stiffer body.
    """
    ours, theirs = sine(CARS[model], speed), THEIRS[model][f"sine {speed:g}"]
    for name in ("r", "ay"):
        assert ours[name] == pytest.approx(theirs[name], rel=2e-3), name
        assert ours[f"{name}_phase"] == pytest.approx(theirs[f"{name}_phase"], abs=0.2), name
    assert ours["beta"] == pytest.approx(theirs["beta"], rel=2e-3, abs=1.3e-3)
    assert ours["beta_phase"] == pytest.approx(theirs["beta_phase"], abs=1.0)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_understeer_gradients_agree(model):
    """The gradient of a slow ramp at 2, 4 and 6 m/s^2, within 1 % by the slip angle of theirs.

    Their slip angle is not quite that of a turned wheel (`_steered_by_their_slip`), which makes
    2.2 urad s^2/m at 2 m/s^2: 1 to 5 % of the gradient. Ours without it is on the page.
    """
    ours, by_their_slip = gradients(CARS[model])
    theirs = THEIRS[model]["ramp 20"]
    (row,) = (line for line in page_rows(model) if len(line) == 4)
    for n, name in enumerate(ACCELERATIONS):
        assert by_their_slip[name] == pytest.approx(theirs[name], rel=0.01), name
        printed = [float(cell) for cell in row[n + 1].split(" / ")]
        # Half of a digit and a bit: another processor may round another way.
        assert printed[0] == pytest.approx(1e3 * ours[name], abs=1.5e-4)
        assert printed[1] == pytest.approx(1e3 * by_their_slip[name], abs=1.5e-4)


def page_rows(model: str) -> list[list[str]]:
    """Cells of the rows that docs/measured.md has of a model."""
    lines = [line for line in PAGE.read_text().splitlines() if line.startswith(f"| {model} |")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
