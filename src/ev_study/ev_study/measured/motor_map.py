"""The losses of a motor with its inverter, from efficiencies measured over speed and torque, and where they are off.

How it works: the loss at a point is a sum of five terms, each a coefficient times a known function
of speed and torque. So it is linear in what is looked for, and non-negative least squares (Lawson
and Hanson) finds it without a start. An error of the loss is weighed by what it does to the
efficiency, since that is what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.figures.panels import Axes, Panel
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import Sheet
from ev_stack.recording.recording import SUMMARY, atomic_file
from ev_stack.report.summary import write_summary
from ev_stack.report.tables import text_table
from ev_study.measured.records.record import UNITS
from ev_study.measured.records.tables import read_columns
from ev_study.measured.records.units import refuse_other_units

MOTOR = "motor.yaml"
_COLUMNS = ("speed_rpm", "torque_nm", "efficiency_inverter_to_mechanical")
_UNITS = {"speed_rpm": "rpm", "torque_nm": "N m"}
_LEAST_RANGE = 2.0  # largest over least speed, and torque: in less all losses look alike
_EVERY = 3  # of the points one is held out
_SHOWN = 2.0  # percentage points, where the colours of the map end


@dataclass(frozen=True)
class MotorFit:
    """Losses by parameter of `vehicle.motor`, and by point speed [rad/s], torque [N m], efficiency and model's [1].

    `held_out` marks the points that the fit has not seen; `left_out` rows of the file have no
    number.
    """

    losses: Mapping[str, float]
    speed: np.ndarray
    torque: np.ndarray
    measured: np.ndarray
    model: np.ndarray
    held_out: np.ndarray
    left_out: int
    digest: str

    def errors(self, held_out: bool) -> tuple[float, float, float]:
        """Median, 90 % and largest of the error of the efficiency, in percentage points."""
        size = 100.0 * np.abs(self.model - self.measured)[self.held_out == held_out]
        return float(np.median(size)), float(np.quantile(size, 0.9)), float(size.max())


def fit_motor(file: Path) -> MotorFit:
    """Least squares in the efficiency, no loss below zero; every third point is held out.

    The file has columns `speed_rpm`, `torque_nm` (of a motor, both above zero) and the efficiency
    from inverter to shaft; rows without all three are left out. Loss: `ev_core.vehicle.losses`.
    ParameterError if it has not.
    """
    columns, digest, units, _ = read_columns(file)
    refuse_other_units(file, units, _UNITS)
    for name in _COLUMNS:
        if name not in columns:
            raise ParameterError(f"{file}: {unknown_name('column', name, columns)}")
    # A point without all three numbers is outside the range that was measured.
    rows = np.stack([columns[name] for name in _COLUMNS])
    whole = np.isfinite(rows).all(axis=0)
    speed, torque, efficiency = rows[:, whole]
    speed = speed * UNITS["rpm"]
    # An efficiency in per cent is refused by this as well: it would be above 1.
    if (
        (speed <= 0.0).any()
        or (torque <= 0.0).any()
        or (efficiency <= 0.0).any()
        or (efficiency > 1.0).any()
    ):
        raise ParameterError(
            f"{file}: expected speed and torque above 0, and efficiencies above 0 and at most 1"
        )
    # Every third row: held-out points lie all over the map.
    held_out = np.arange(len(speed)) % _EVERY == _EVERY - 1
    terms = {
        "copper_loss": torque**2,
        "iron_loss": speed,
        "eddy_loss": speed**2,
        "inverter_loss": np.ones(len(speed)),
        "inverter_torque_loss": torque,
    }
    if np.sum(~held_out) < len(terms):
        raise ParameterError(
            f"{file} has {len(speed)} points with numbers, expected {2 * len(terms)} or more"
        )
    for name, values in zip(_COLUMNS[:2], rows[:2, whole], strict=True):
        low, high = values.min(), values.max()
        if high < _LEAST_RANGE * low:
            raise ParameterError(
                f"{file}: {name} is {low:g} to {high:g}, expected {_LEAST_RANGE:g} times as much "
                "as the least or more: in less no loss can be distinguished"
            )
    power = speed * torque
    # From eta = P/(P + L) follows d eta/dL = -eta^2/P.
    weight = efficiency**2 / power  # a watt of loss in the efficiency
    matrix = np.stack([*terms.values()], axis=1)
    weighed = (weight[:, None] * matrix)[~held_out]
    # Columns of length one: torque squared and the constant are orders of magnitude apart.
    size = np.linalg.norm(weighed, axis=0)
    # P (1/eta - 1) is the loss that was measured.
    found, _ = nnls(weighed / size, (weight * power * (1.0 / efficiency - 1.0))[~held_out])
    # The column lengths are taken out again.
    losses = dict(zip(terms, (found / size).tolist(), strict=True))
    model = power / (power + matrix @ (found / size))
    return MotorFit(losses, speed, torque, efficiency, model, held_out, int(np.sum(~whole)), digest)


def motor_table(fit: MotorFit) -> str:
    """The losses, and the errors of the efficiency on both parts."""
    rows = [
        [part, *(f"{error:.2f}" for error in fit.errors(held))]
        for part, held in (("seen", False), ("held out", True))
    ]
    columns = ("points", "median error [%]", "90 % within", "largest")
    losses = [[f"vehicle.motor.{name}", f"{value:.5g}"] for name, value in fit.losses.items()]
    return f"{text_table(('parameter', 'value'), losses, ('parameter',))}\n\n{text_table(columns, rows, columns[:1])}"


def write_motor(folder: Path, fit: MotorFit, command: str) -> None:
    """Parameters for --params, the numbers, and the map of the errors, into a folder."""
    head = (
        f"identified from a motor map, SHA-256 {fit.digest[:12]}: {len(fit.speed)} points,"
        f" {fit.left_out} left out"
    )
    lines = [
        f"# {head}",
        f"# {command}",
        "/**:",
        "  ros__parameters:",
        "    vehicle:",
        "      motor:",
    ]
    lines += [f"        {name}: {value!r}" for name, value in fit.losses.items()]
    with atomic_file(folder / MOTOR) as file:
        file.write(("\n".join(lines) + "\n").encode())
    names = ("median", "ninety_percent_within", "largest")
    errors = {
        part: dict(zip(names, fit.errors(held), strict=True))
        for part, held in (("seen", False), ("held_out", True))
    }
    write_summary(
        folder / SUMMARY,
        {"about": head, "command": command, "losses": dict(fit.losses), "errors": errors},
    )
    panel = Panel(
        "error of the efficiency",
        "torque [N m]",
        ground=partial(_draw, fit=fit),
        xlabel="speed [rpm]",
        shape=0.8,
    )
    save_figures({"error_map": Sheet([panel]).figure()}, folder)


def _draw(axes: Axes, fit: MotorFit) -> None:
    """Model less measured by colour; points that the fit has not seen have a rim."""
    # In percentage points.
    error = 100.0 * (fit.model - fit.measured)
    rims = np.where(fit.held_out, 0.8, 0.0)
    drawn = axes.scatter(
        fit.speed / UNITS["rpm"], fit.torque, c=error, s=28.0, cmap="coolwarm", vmin=-_SHOWN, vmax=_SHOWN,
        edgecolors="black", linewidths=rims,
    )  # fmt: skip
    axes.figure.colorbar(drawn, ax=axes, label="model less measured [percentage points]")
