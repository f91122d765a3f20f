"""Tyre rig data: sweeps of slip at a load, an inclination and a pressure, in CSV or in files of the FSAE TTC.

How it works: the columns become arrays in SI and ISO axes. A new sweep begins where the rig has
paused, or, in a log without pauses, where load, inclination or pressure change by more than they
fluctuate. Sweeps are the unit of everything behind this: a fit holds out whole ones, and by the
slips in a sweep it is one of side force, of longitudinal force or of both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import find_peaks

from ev_core.parameters.data_file import SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError
from ev_study.measured.magic_formula import Points
from ev_study.measured.records.tables import read_columns
from ev_study.measured.records.units import refuse_other_units

# The names of the FSAE Tire Test Consortium, SAE axes, with the factor to SI and ISO: z is down
# there, y to the right.
_COLUMNS = {
    "slip_ratio": ("SL", 1.0),
    "slip_angle": ("SA", -np.pi / 180),
    "inclination": ("IA", np.pi / 180),
    "load": ("FZ", -1.0),
    "pressure": ("P", 1e3),
    "longitudinal_force": ("FX", 1.0),
    "lateral_force": ("FY", -1.0),
}
_UNITS = {"ET": "s", "SA": "deg", "IA": "deg", "FZ": "N", "P": "kPa", "FX": "N", "FY": "N"}
# What the rig holds during a sweep, and how much it changes at least from one to the next.
SETTINGS = {"FZ": 150.0, "IA": 0.5, "P": 5.0}  # N, deg, kPa
AROUND = 50  # samples, half a second at 100 Hz: load and inclination take as long to settle
LEAST_LOAD, MOST_LOAD = 50.0, 60e3  # N; a tyre of a model car, and one of a lorry
LEAST_PRESSURE, MOST_PRESSURE = 40.0, 1200.0  # kPa; a tyre at 6 psi has 41, that of a lorry 900
# [s] without samples between two sweeps: the rig changes load, inclination or pressure there
GAP = 0.5
# largest slip ratio of a sweep of the slip angle alone, and slip angle [rad] of one of the ratio
ROLLS_FREELY = 0.01


@dataclass(frozen=True)
class Sweeps:
    """The samples of all files, and by sample the number of its sweep.

    `passed_over` counts the samples that lack a number or have no load.
    """

    points: Points
    number: np.ndarray
    digest: str
    passed_over: int = 0

    @property
    def count(self) -> int:
        """Number of sweeps."""
        return int(self.number[-1]) + 1

    @property
    def is_lateral(self) -> np.ndarray:
        """Mask of the samples of sweeps in which the wheel rolls freely throughout."""
        return self._everywhere(np.abs(self.points.slip_ratio) < ROLLS_FREELY)

    @property
    def is_longitudinal(self) -> np.ndarray:
        """Mask of the samples of sweeps straight throughout, driven or braked."""
        return self._everywhere(np.abs(self.points.slip_angle) < ROLLS_FREELY) & ~self.is_lateral

    def _everywhere(self, holds: np.ndarray) -> np.ndarray:
        # 95 %, not all: a few samples of noise do not make a sweep one of another kind.
        share = np.bincount(self.number, holds) / np.bincount(self.number)
        found: np.ndarray = (share > 0.95)[self.number]
        return found


def read_rig(paths: list[Path]) -> Sweeps:
    """The sweeps of some files (.csv, .csv.xz, or .mat of the TTC).

    Raises ParameterError if one is not of this kind.
    """
    tables, digests = [], []
    for path in paths:
        columns, digest = _mat(path) if path.suffix == ".mat" else _table(path)
        if lacking := [
            name for name in ("ET", *(n for n, _ in _COLUMNS.values())) if name not in columns
        ]:
            raise ParameterError(
                f"{path}: lacks {', '.join(lacking)}, expected a table of the FSAE TTC (SAE, SI)"
            )
        _check_units(path, columns)
        tables.append(columns)
        digests.append(digest[:12])
    number, last = [], -1
    for columns in tables:
        # Numbers go on from file to file, so that no two sweeps share one.
        of = last + 1 + np.concatenate([[0], np.cumsum(_begins(columns))])
        number.append(of)
        last = int(of[-1])
    # From here on SI and ISO.
    points = Points(
        **{
            name: factor * np.concatenate([t[column] for t in tables])
            for name, (column, factor) in _COLUMNS.items()
        }
    )
    whole = np.all([np.isfinite(getattr(points, name)) for name in _COLUMNS], axis=0) & (
        points.load > 0.0
    )
    # Numbered anew: a sweep of which no sample is left would be a hole in the count.
    numbers = np.unique(np.concatenate(number)[whole], return_inverse=True)[1]
    found = Sweeps(points.some(whole), numbers, " ".join(digests), int(np.sum(~whole)))
    # After the conversion: a file that is in ISO already shows here.
    _check_signs(", ".join(map(str, paths)), found)
    return found


def _begins(columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Behind which samples another sweep begins, (n - 1,): a pause or a time that goes back, without any a setting."""
    steps = np.diff(columns["ET"])
    # A time that goes back begins another log in the same file.
    found: np.ndarray = (steps > GAP) | (steps < 0.0)
    if found.any():
        return found
    # Only a log without any pause gets here: in others the settings change within the pause.
    for name, least in SETTINGS.items():
        found |= _changes(columns[name], least)
    return found


def _changes(values: np.ndarray, least: float) -> np.ndarray:
    """Find where medians of `AROUND` samples on both sides differ by over `least`, (n - 1,)."""
    changed = np.zeros(len(values) - 1, bool)
    if len(values) < 2 * AROUND:
        return changed
    # Medians, so that a few noisy samples are no change.
    medians = np.median(np.lib.stride_tricks.sliding_window_view(values, AROUND), axis=1)
    apart = np.abs(medians[AROUND:] - medians[:-AROUND])
    # A change shows for as long as it lies within the two windows; only the middle of that is it.
    peaks, _ = find_peaks(np.concatenate([[0.0], apart, [0.0]]), height=least, distance=AROUND)
    # Less the zero in front; window n ends with sample n + AROUND - 1, behind which the change
    # lies.
    changed[peaks - 1 + AROUND - 1] = True
    return changed


def _check_units(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    """Refuse loads and pressures that are none in N and kPa, and loads that are not below zero."""
    # By the median: a few samples without load decide nothing.
    load, pressure = float(np.nanmedian(columns["FZ"])), float(np.nanmedian(columns["P"]))
    if load >= 0.0:
        raise ParameterError(
            f"{path}: FZ is {load:.4g} N in the median, expected below 0 (SAE: z is down)"
        )
    if not LEAST_LOAD <= -load <= MOST_LOAD:
        expected = (
            f"expected -{MOST_LOAD:g} to -{LEAST_LOAD:g} N: the unit of FZ, and of the forces"
            " with it?"
        )
        raise ParameterError(f"{path}: FZ is {load:.4g} N in the median, {expected}")
    if not LEAST_PRESSURE <= pressure <= MOST_PRESSURE:
        expected = (
            f"expected {LEAST_PRESSURE:g} to {MOST_PRESSURE:g} kPa: the unit of P, and of the"
            " forces with it?"
        )
        raise ParameterError(f"{path}: P is {pressure:.4g} kPa in the median, {expected}")


def _check_signs(where: str, sweeps: Sweeps) -> None:
    """Refuse forces that a tyre does not make: a side force with its slip angle, a drive force against its slip."""
    points = sweeps.points
    for name, force, slip, chosen, sign in (
        ("FY", points.lateral_force, points.slip_angle, sweeps.is_lateral, -1.0),
        ("FX", points.longitudinal_force, points.slip_ratio, sweeps.is_longitudinal, 1.0),
    ):
        # ISO axes here: side force against the slip angle, longitudinal force with the slip ratio.
        if sign * float(np.sum(force[chosen] * slip[chosen])) < 0.0:
            expected = (
                "SA, expected the opposite one"
                if name == "FY"
                else "the opposite of SL, expected the same"
            )
            raise ParameterError(f"{where}: {name} has the sign of {expected} (SAE)")


def _table(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """The columns of a CSV file of the TTC."""
    table = read_columns(path)
    refuse_other_units(path, table.units, _UNITS)
    return table.columns, table.digest


def _mat(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """The columns of a MATLAB file of the TTC."""
    import hashlib

    from scipy.io import loadmat

    try:
        # Refuses a fifo or a file that is too large before scipy opens it.
        content = read_data(path, SIGNALS)
        found = loadmat(path)
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror or error}") from None
    # NotImplementedError: version 7.3 is an HDF5 file, which scipy does not read.
    except (ValueError, NotImplementedError, TypeError) as error:
        raise ParameterError(
            f"{path} is no MATLAB file up to version 7.2: {' '.join(str(error).split())[:200]}"
        ) from None
    columns = {
        name: np.ravel(v).astype(float)
        for name, v in found.items()
        # Texts and structures beside the channels (units, test conditions) are no columns.
        if isinstance(v, np.ndarray) and v.dtype.kind in "fiu"
    }
    return columns, hashlib.sha256(content).hexdigest()
