"""Files of the identification of a tyre: its property file, its errors, and curves over data."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from ev_stack.figures.panels import Axes, Panel, readable
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import HUES
from ev_stack.recording.recording import SUMMARY, atomic_file
from ev_stack.report.summary import write_summary
from ev_stack.report.tables import text_table
from ev_study.measured.magic_formula import combined_lateral, combined_longitudinal
from ev_study.measured.rig import Sweeps
from ev_study.measured.tyre_fit import TyreFit, is_held_out

TYRE = "tyre.tir"
_ANGLE = "slip_angle"


def tyre_table(fit: TyreFit) -> str:
    """Errors by kind of force, of the sweeps that the fit has seen and of those that it has not."""
    rows = []
    for kind, error in fit.seen.items():
        unseen = f"{100 * fit.unseen[kind]:.2f} %" if kind in fit.unseen else "none"
        rows.append([kind, f"{100 * error:.2f} %", unseen])
    table = text_table(("force", "RMS over largest, seen", "unseen sweeps"), rows, left=("force",))
    return "\n".join([table, *_not_identified(fit)])


def _not_identified(fit: TyreFit) -> list[str]:
    """A line each on the coefficients without a sweep and on those that the sweeps do not decide."""
    lines = {
        "not identified, no sweep is there for them, assumed": fit.at_start,
        "not decided by these sweeps, near what is assumed": fit.undecided,
    }
    return [f"{what}: {', '.join(names)}" for what, names in lines.items() if names]


def write_tyre(
    folder: Path, fit: TyreFit, sweeps: Sweeps, friction_scale: float, command: str
) -> None:
    """Everything into a folder."""
    head = "\n".join(
        [f"identified from rig data, SHA-256 {sweeps.digest}", command, *_not_identified(fit)]
    )
    with atomic_file(folder / TYRE) as file:
        file.write(property_file(fit, friction_scale, head).encode())
    content = {
        "about": head,
        "seen": dict(fit.seen),
        "unseen": dict(fit.unseen),
        "assumed": [*fit.at_start, *fit.undecided],
        "sweeps": sweeps.count,
        "samples_passed_over": sweeps.passed_over,
    }
    write_summary(folder / SUMMARY, content | {"coefficients": dict(fit.coefficients)})
    save_figures({"curves": curves(fit, sweeps).figure()}, folder)


def curves(fit: TyreFit, sweeps: Sweeps) -> Sheet:
    """Forces of the sweeps over their slip, with the curve of the fit at the means of each.

    Unseen ones in orange.
    """

    def over_slip(axes: Axes, slip: str, force: str, chosen: np.ndarray) -> None:
        model, factor = (
            (combined_lateral, np.degrees(1.0)) if slip == _ANGLE else (combined_longitudinal, 1.0)
        )
        # About a dozen sweeps; hundreds of curves over each other show nothing.
        for number in np.unique(sweeps.number[chosen])[
            :: max(len(np.unique(sweeps.number[chosen])) // 12, 1)
        ]:
            # Each tenth sample is enough for the eye.
            data = sweeps.points.some(np.flatnonzero(sweeps.number == number)[::10])
            grid = np.linspace(getattr(data, slip).min(), getattr(data, slip).max(), 200)
            names = data.__dataclass_fields__
            # The curve belongs to one load, inclination and pressure: those of the sweep on
            # average.
            mean = replace(data, **{n: np.full(200, getattr(data, n).mean()) for n in names})
            colour, label = "0.6", "seen by the fit"
            if is_held_out(number):
                colour, label = "#E69F00", "unseen"
            axes.plot(
                factor * getattr(data, slip),
                getattr(data, force),
                ".",
                color=colour,
                markersize=2,
                label=label,
            )
            values = model(fit.coefficients, replace(mean, **{slip: grid}))
            axes.plot(factor * grid, values, color=HUES[0], label="fit")

    panels = [
        Panel(
            readable(force),
            "force [N]",
            ground=partial(over_slip, slip=slip, force=force, chosen=chosen),
            xlabel=xlabel,
            shape=0.8,
        )
        for slip, xlabel, force, chosen in (
            (_ANGLE, "slip angle [deg]", "lateral_force", sweeps.is_lateral),
            ("slip_ratio", "slip ratio [1]", "longitudinal_force", sweeps.is_longitudinal),
        )
    ]
    return Sheet(panels)


def property_file(fit: TyreFit, friction_scale: float, head: str) -> str:
    """A tyre property file of MF 6.1.

    `friction_scale` from the belt of the rig to the road is LMUX and LMUY.
    """
    assumed = {*fit.at_start, *fit.undecided}
    groups = (
        ("MODEL", {"FITTYP": "61", "TYRESIDE": "'LEFT'"}),
        (
            "UNITS",
            {
                "LENGTH": "'meter'",
                "FORCE": "'newton'",
                "ANGLE": "'radians'",
                "MASS": "'kg'",
                "TIME": "'second'",
            },
        ),
        ("SCALING_COEFFICIENTS", {"LMUX": f"{friction_scale:g}", "LMUY": f"{friction_scale:g}"}),
        (
            "COEFFICIENTS",
            {n: f"{v:.9g}" for n, v in sorted(fit.coefficients.items()) if n not in assumed},
        ),
        (
            # Our reader goes by names, so a section more does no harm.
            "COEFFICIENTS_THAT_ARE_ASSUMED",
            {n: f"{fit.coefficients[n]:.9g}" for n in sorted(assumed)},
        ),
    )
    lines = [f"$ {line}" for line in head.splitlines()]
    for title, entries in groups:
        if not entries:
            continue
        lines += [f"[{title}]", *(f"{name:16} = {value}" for name, value in entries.items())]
    return "\n".join(lines) + "\n"
