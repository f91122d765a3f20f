"""Slip curve by least squares (figure 2.8): samples, fit, two zones, and curve of the road."""

from __future__ import annotations

from functools import partial

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.measures.slip_curve import (
    SlipCurve,
    first_passed_peak,
    slip_and_road_torque,
)
from ev_sim.surfaces import curve_on_road
from ev_stack.figures.panels import Axes, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import HUES
from ev_stack.measures.handling import surfaces_under
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

AROUND = 0.1  # [s] before and after the window, of which samples are drawn, too
_ALLOWED = "#E3F1E6"  # zone up to the peak
_BEYOND = "#FBE3DC"
_PASSED = "#B00020"
_SLIP = "slip x = 1 - w_free/w [1]"
_SHAPE = 0.55  # height over width


def slip_curve_figure(run: Recording, vehicle: Vehicle) -> Sheet:
    """Road torque over slip where the left driven wheel first passes its peak."""
    title = "Slip curve by least squares"
    ylabel = "road torque y = (M - J w')/M_nom [1]"
    try:
        wheel = _left_wheel(vehicle)
        title = f"{title}, {readable(wheel)} wheel"
        curve = first_passed_peak(run, vehicle, wheel)
    except NotMeasured as why:
        note = f"not measured: {why}"
        return Sheet([Panel(title, ylabel, note=note, xlabel=_SLIP, shape=_SHAPE)])
    ground = partial(_draw, run=run, vehicle=vehicle, wheel=wheel, curve=curve)
    return Sheet([Panel(title, ylabel, ground=ground, xlabel=_SLIP, shape=_SHAPE)])


def _left_wheel(vehicle: Vehicle) -> str:
    for wheel in vehicle.driven_wheels:
        if wheel.endswith("left"):
            return wheel
    raise NotMeasured("no wheel is driven on the left")


def _draw(axes: Axes, run: Recording, vehicle: Vehicle, wheel: str, curve: SlipCurve) -> None:
    x, y = slip_and_road_torque(run, vehicle, wheel)
    peak = curve.peak
    hit = curve.window.stop - 1
    begin = run.time[curve.window.start] - AROUND
    end = run.time[hit] + AROUND
    around = (run.time >= begin) & (run.time <= end) & (x >= 0.0)
    right = max(1.15 * x[around].max(), 2.0 * peak)
    top = 1.18 * max(y[around].max(), float(curve.at(np.array(peak))))
    slips = np.linspace(0.0, right, 300)
    axes.axvspan(0.0, peak, facecolor=_ALLOWED, edgecolor="none")
    axes.axvspan(peak, right, facecolor=_BEYOND, edgecolor="none")
    samples = f"samples from {begin:.2f} s to {end:.2f} s"
    axes.plot(x[around], y[around], ".", color="0.6", label=samples)
    axes.plot(x[curve.window], y[curve.window], "o", color=HUES[0], label="window of the fit")
    label = f"y = {curve.a:.3g} x + {curve.b:.3g} sqrt(x)"
    axes.plot(slips, curve.at(slips), color=HUES[1], lw=1.6, label=label)
    surface, true = _of_the_road(run, vehicle, wheel, curve, y, slips)
    axes.plot(slips, true, color="0.25", linestyle="--", label=readable(surface))
    axes.axvline(peak, color="0.3", lw=0.9)
    passed = f"peak passed at {run.time[hit]:.3f} s"
    axes.plot(x[hit], y[hit], "D", color=_PASSED, ms=6, label=passed)
    axes.text(peak / 2, 0.98 * top, "zone 1: allowed slip", ha="center", va="top")
    beyond = (peak + right) / 2
    axes.text(beyond, 0.98 * top, "zone 2: beyond the grip", ha="center", va="top")
    slope = f"dy/dx = 0 at x = {peak:.4f}"
    axes.annotate(slope, (peak, 0.03 * top), (4, 0), textcoords="offset points")
    axes.set_xlim(0.0, right)
    axes.set_ylim(0.0, top)


def _of_the_road(
    run: Recording, vehicle: Vehicle, wheel: str, curve: SlipCurve, y: np.ndarray, slips: np.ndarray
) -> tuple[str, np.ndarray]:
    """Surface under the wheel, and road torque that it takes at slips, (n,) [1].

    Load and resistance are the means of the window.
    """
    part = curve.window
    surface = str(surfaces_under(run, vehicle, wheel)[part.stop - 1])
    friction_use, _ = curve_on_road(vehicle.tyre, surface)
    nominal = vehicle.motor.nominal_torque * vehicle.gear_ratio
    load = channel(run, f"tire_forces.load.{wheel}")[part].mean()
    force = channel(run, f"tire_forces.longitudinal_force.{wheel}")[part]
    resistance = (y[part] - force * vehicle.wheel_radius / nominal).mean()
    use = np.array([friction_use(slip) for slip in slips])
    return surface, use * load * vehicle.wheel_radius / nominal + resistance
