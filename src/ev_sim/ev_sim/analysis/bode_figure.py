"""Bode plot of the slip angles."""

from __future__ import annotations

import numpy as np
from scipy.signal import bode

from ev_sim.analysis.linear_models import SideSlipModel
from ev_sim.analysis.linearised_plant import LinearisedPlant
from ev_sim.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.figures.figure import Figure, new_figure

FREQUENCIES = np.logspace(-1.0, 1.5, 200)  # [Hz]; a driver steers with up to about 3 Hz
WIDTH, HEIGHT = 9.2, 4.6  # [inch]


def bode_figure(model: SideSlipModel, plant: LinearisedPlant) -> Figure:
    """Magnitude and phase of dA/delta: W12, W12 with the steering rate that it drops, and the linearised plant."""
    omega = 2 * np.pi * FREQUENCIES
    curves = {
        "W12 with the steering rate": _decibels(model.response_with_steering_rate(omega)),
        "planar plant, linearised": _decibels(plant.slip_angle_difference(omega)),
    }
    if model.excitation:  # a car that steers neutrally has no W12 to draw
        _, *w12 = bode(model.transfer_function(), omega)
        curves = {"W12": tuple(w12), **curves}
    figure = new_figure(WIDTH, HEIGHT, layout="constrained")
    magnitude, phase = figure.subplots(2, 1, sharex=True)
    for number, (label, (decibels, degrees)) in enumerate(curves.items()):
        colour, dashes = STROKES[number]
        magnitude.semilogx(FREQUENCIES, decibels, color=colour, linestyle=dashes, linewidth=1.2, label=label)
        phase.semilogx(FREQUENCIES, degrees, color=colour, linestyle=dashes, linewidth=1.2)
    magnitude.set_title(
        f"Slip angles of rear minus front axle over the road-wheel angle, {model.speed:g} m/s",
        loc="left",
        fontsize=TITLE_SIZE,
    )
    magnitude.set_ylabel("magnitude [dB]", fontsize=TEXT_SIZE)
    phase.set_ylabel("phase [deg]", fontsize=TEXT_SIZE)
    phase.set_xlabel("frequency [Hz]", fontsize=TEXT_SIZE)
    magnitude.legend(fontsize=TEXT_SIZE, frameon=False)
    for axes in (magnitude, phase):
        axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
        axes.grid(True, which="both", color="0.9", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _decibels(response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Magnitude [dB] and phase without jumps [deg]."""
    return 20 * np.log10(np.abs(response)), np.degrees(np.unwrap(np.angle(response)))
