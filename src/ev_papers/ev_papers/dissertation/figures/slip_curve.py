"""Figure 2.8 of the dissertation from signals."""

from __future__ import annotations

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.measures.slip_curve import SlipCurve, first_passed_peak, slip_and_road_torque
from ev_sim.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE, Axes, Figure, name_axes, new_figure
from ev_sim.measures.handling import surfaces_under
from ev_sim.measures.metric import NotMeasured, channel
from ev_sim.recording.recording import Recording
from ev_sim.surfaces import curve_on_road
from ev_sim.tyres.curve import FRICTION_CURVES, friction

AROUND = 0.1  # [s] before and after the window, of which samples are drawn, too
_ALLOWED, _BEYOND = "#E3F1E6", "#FBE3DC"


def slip_curve_figure(run: Recording, vehicle: Vehicle) -> Figure:
    """Road torque over slip where the left driven wheel first passes its peak: samples, fit and its two zones."""
    figure = new_figure(6.4, 4.2)
    figure.subplots_adjust(left=0.11, right=0.98, bottom=0.12, top=0.92)
    axes = figure.add_subplot()
    labels = "slip x = 1 - w_free/w [1]", "road torque y = (M - J w')/M_nom [1]"
    name_axes(axes, "Slip curve by least squares", *labels, grid="", pad=6.0)
    try:
        wheel = _left_wheel(vehicle)
        axes.set_title(f"Slip curve by least squares, {wheel.replace('_', ' ')} wheel", loc="left", fontsize=TITLE_SIZE)
        _draw(axes, run, vehicle, wheel, first_passed_peak(run, vehicle, wheel))
    except NotMeasured as why:
        note = f"not measured: {why}"
        axes.text(0.5, 0.5, note, transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE, color="0.4")
    return figure


def _left_wheel(vehicle: Vehicle) -> str:
    for wheel in vehicle.driven_wheels:
        if wheel.endswith("left"):
            return wheel
    raise NotMeasured("no wheel is driven on the left")


def _draw(axes: Axes, run: Recording, vehicle: Vehicle, wheel: str, curve: SlipCurve) -> None:
    x, y = slip_and_road_torque(run, vehicle, wheel)
    begin, end = run.time[curve.window.start] - AROUND, run.time[curve.window.stop - 1] + AROUND
    around = (run.time >= begin) & (run.time <= end) & (x >= 0.0)
    peak, hit = curve.peak, curve.window.stop - 1
    right = max(1.15 * x[around].max(), 2.0 * peak)
    top = 1.18 * max(y[around].max(), float(curve.at(np.array(peak))))
    slips = np.linspace(0.0, right, 300)
    axes.axvspan(0.0, peak, facecolor=_ALLOWED, edgecolor="none")
    axes.axvspan(peak, right, facecolor=_BEYOND, edgecolor="none")
    axes.plot(x[around], y[around], ".", color="0.6", ms=4, label=f"samples from {begin:.2f} s to {end:.2f} s")
    axes.plot(x[curve.window], y[curve.window], "o", color=STROKES[0][0], ms=4, label="window of the fit")
    label = f"y = {curve.a:.3g} x + {curve.b:.3g} sqrt(x)"
    axes.plot(slips, curve.at(slips), color=STROKES[1][0], lw=1.6, label=label)
    surface, true = _of_the_road(run, vehicle, wheel, curve, y, slips)
    axes.plot(slips, true, color="0.25", linestyle=STROKES[1][1], lw=1.0, label=surface.replace("_", " "))
    axes.axvline(peak, color="0.3", lw=0.9)
    axes.plot(x[hit], y[hit], "D", color="#B00020", ms=6, label=f"peak passed at {run.time[hit]:.3f} s")
    for place, number, words in ((peak / 2, 1, "allowed slip"), ((peak + right) / 2, 2, "beyond the grip")):
        axes.text(place, 0.98 * top, f"zone {number}: {words}", ha="center", va="top", fontsize=TEXT_SIZE)
    axes.annotate(
        f"dy/dx = 0 at x = {peak:.4f}", (peak, 0.03 * top), (4, 0), textcoords="offset points", fontsize=TEXT_SIZE
    )
    axes.set_xlim(0.0, right)
    axes.set_ylim(0.0, top)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.08), fontsize=TEXT_SIZE, framealpha=0.85)


def _of_the_road(
    run: Recording, vehicle: Vehicle, wheel: str, curve: SlipCurve, y: np.ndarray, slips: np.ndarray
) -> tuple[str, np.ndarray]:
    """The surface under the wheel, and what it takes at slips (n,) under the mean load and resistance of the window."""
    part = curve.window
    surface = str(surfaces_under(run, vehicle, wheel)[part.stop - 1])
    curve_name, of = curve_on_road(vehicle.tyre, surface)
    kind = FRICTION_CURVES.index(curve_name)
    nominal = vehicle.motor.nominal_torque * vehicle.gear_ratio
    load = channel(run, f"tire_forces.load.{wheel}")[part].mean()
    force = channel(run, f"tire_forces.longitudinal_force.{wheel}")[part]
    resistance = (y[part] - force * vehicle.wheel_radius / nominal).mean()
    use = np.array([friction(kind, slip, of) for slip in slips])
    return surface, use * load * vehicle.wheel_radius / nominal + resistance
