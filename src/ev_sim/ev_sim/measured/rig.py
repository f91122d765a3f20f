"""Tyre rig data: sweeps of slip at a load, an inclination and a pressure, in CSV or in files of the FSAE TTC."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError
from ev_sim.measured.magic_formula import Points
from ev_sim.measured.records.tables import read_columns

# The names of the FSAE Tire Test Consortium, SAE axes, with the factor to SI and ISO: z is down there, y to the right.
_COLUMNS = {
    "slip_ratio": ("SL", 1.0),
    "slip_angle": ("SA", -np.pi / 180),
    "inclination": ("IA", np.pi / 180),
    "load": ("FZ", -1.0),
    "pressure": ("P", 1e3),
    "longitudinal_force": ("FX", 1.0),
    "lateral_force": ("FY", -1.0),
}
GAP = 0.5  # [s] without samples between two sweeps: the rig changes load, inclination or pressure there
ROLLS_FREELY = 0.01  # largest slip ratio of a sweep of the slip angle alone, and slip angle [rad] of one of the ratio


@dataclass(frozen=True)
class Sweeps:
    """The samples of all files, and by sample the number of its sweep."""

    points: Points
    number: np.ndarray
    digest: str

    @property
    def count(self) -> int:
        """How many sweeps there are."""
        return int(self.number[-1]) + 1

    @property
    def is_lateral(self) -> np.ndarray:
        """By sample whether the wheel rolls freely throughout its sweep."""
        return self._everywhere(np.abs(self.points.slip_ratio) < ROLLS_FREELY)

    @property
    def is_longitudinal(self) -> np.ndarray:
        """By sample whether it runs straight throughout its sweep, and is driven or braked."""
        return self._everywhere(np.abs(self.points.slip_angle) < ROLLS_FREELY) & ~self.is_lateral

    def _everywhere(self, holds: np.ndarray) -> np.ndarray:
        share = np.bincount(self.number, holds) / np.bincount(self.number)
        found: np.ndarray = (share > 0.95)[self.number]
        return found


def read_rig(paths: list[Path]) -> Sweeps:
    """The sweeps of some files (.csv, .csv.xz, or .mat of the TTC); ParameterError if one is not of this kind."""
    tables, digests = [], []
    for path in paths:
        columns, digest = _mat(path) if path.suffix == ".mat" else read_columns(path)[:2]
        if lacking := [name for name in ("ET", *(n for n, _ in _COLUMNS.values())) if name not in columns]:
            raise ParameterError(f"{path}: lacks {', '.join(lacking)}, allowed is a table of the FSAE TTC (SAE, SI)")
        tables.append(columns)
        digests.append(digest[:12])
    number, last = [], -1
    for columns in tables:
        steps = np.diff(columns["ET"])
        of = last + 1 + np.concatenate([[0], np.cumsum((steps > GAP) | (steps < 0.0))])
        number.append(of)
        last = int(of[-1])
    points = Points(
        **{name: factor * np.concatenate([t[column] for t in tables]) for name, (column, factor) in _COLUMNS.items()}
    )
    whole = np.all([np.isfinite(getattr(points, name)) for name in _COLUMNS], axis=0) & (points.load > 0.0)
    return Sweeps(
        points.some(whole), np.unique(np.concatenate(number)[whole], return_inverse=True)[1], " ".join(digests)
    )


def _mat(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """The columns of a MATLAB file of the TTC."""
    import hashlib

    from scipy.io import loadmat

    try:
        content = read_data(path, SIGNALS)
        found = loadmat(path)
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror or error}") from None
    except (ValueError, NotImplementedError, TypeError) as error:
        raise ParameterError(
            f"{path} is no MATLAB file up to version 7.2: {' '.join(str(error).split())[:200]}"
        ) from None
    columns = {
        name: np.ravel(v).astype(float)
        for name, v in found.items()
        if isinstance(v, np.ndarray) and v.dtype.kind in "fiu"
    }
    return columns, hashlib.sha256(content).hexdigest()
