"""Figures of a run of the urban cycle on mixed surfaces, like the dissertation's 2.8, 3.1 to 3.10 and 5.1 to 5.25."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.figures.urban_sheets import (
    both_sides,
    each_side,
    left_and_right,
    over_cycle,
    recorded,
)
from ev_papers.dissertation.measures.circuits import CircuitShares, circuit_shares
from ev_papers.dissertation.measures.slip_curve import (
    SlipCurve,
    first_passed_peak,
    slip_and_road_torque,
)
from ev_papers.dissertation.measures.traction_windows import traction
from ev_sim.surfaces import curve_on_road
from ev_sim.tyres.curve import FRICTION_CURVES, friction
from ev_stack.figures.panels import Axes, Curve, Panel, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import HUES
from ev_stack.measures import motion
from ev_stack.measures.handling import surfaces_under
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

AROUND = 0.1  # [s] before and after the window, of which samples are drawn, too
_ALLOWED, _BEYOND = "#E3F1E6", "#FBE3DC"
_SLIP, _SHAPE = (
    "slip x = 1 - w_free/w [1]",
    0.55,
)  # abscissa, and height over width of the slip curve


def slip_curve_figure(run: Recording, vehicle: Vehicle) -> Sheet:
    """Road torque over slip where the left driven wheel first passes its peak: samples, fit and its two zones."""
    title, ylabel = "Slip curve by least squares", "road torque y = (M - J w')/M_nom [1]"
    try:
        wheel = _left_wheel(vehicle)
        title = f"{title}, {readable(wheel)} wheel"
        ground = partial(
            _draw,
            run=run,
            vehicle=vehicle,
            wheel=wheel,
            curve=first_passed_peak(run, vehicle, wheel),
        )
    except NotMeasured as why:
        return Sheet(
            [Panel(title, ylabel, note=f"not measured: {why}", xlabel=_SLIP, shape=_SHAPE)]
        )
    return Sheet([Panel(title, ylabel, ground=ground, xlabel=_SLIP, shape=_SHAPE)])


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
    axes.plot(
        x[around], y[around], ".", color="0.6", label=f"samples from {begin:.2f} s to {end:.2f} s"
    )
    axes.plot(x[curve.window], y[curve.window], "o", color=HUES[0], label="window of the fit")
    label = f"y = {curve.a:.3g} x + {curve.b:.3g} sqrt(x)"
    axes.plot(slips, curve.at(slips), color=HUES[1], lw=1.6, label=label)
    surface, true = _of_the_road(run, vehicle, wheel, curve, y, slips)
    axes.plot(slips, true, color="0.25", linestyle="--", label=readable(surface))
    axes.axvline(peak, color="0.3", lw=0.9)
    axes.plot(
        x[hit], y[hit], "D", color="#B00020", ms=6, label=f"peak passed at {run.time[hit]:.3f} s"
    )
    for place, number, words in (
        (peak / 2, 1, "allowed slip"),
        ((peak + right) / 2, 2, "beyond the grip"),
    ):
        axes.text(place, 0.98 * top, f"zone {number}: {words}", ha="center", va="top")
    axes.annotate(
        f"dy/dx = 0 at x = {peak:.4f}", (peak, 0.03 * top), (4, 0), textcoords="offset points"
    )
    axes.set_xlim(0.0, right)
    axes.set_ylim(0.0, top)


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


DETAIL = 15.0  # [s], length of the figure in which single pulses can be seen
OF_A_CIRCUIT = (
    "torque",
    "speed",
    "current",
    "voltage",
    "drive efficiency",
)  # of a circuit, by the figures of chapter 5


def panels(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, list[Panel]]:
    """Each of the OF_A_CIRCUIT of both circuits, left and right; on a test bench as its transducers show them.

    One battery feeds both circuits, so without a bench both have its voltage. The efficiency is that of eq 2.38.
    """
    on_bench = any(name.startswith("bench.shafts.") for name in run.channels)

    def shown_by(title: str, ylabel: str, quantity: str) -> list[Panel]:
        return recorded(run, vehicle, title, ylabel, (quantity, ""))

    efficiency = each_side(
        vehicle,
        "Drive efficiency in the traction windows since the start",
        "efficiency [1]",
        lambda wheel: _drive_efficiency(run, vehicle, driver, wheel),
    )
    efficiency = [replace(each, ends=(0.5, 1.0)) for each in efficiency]
    if on_bench:
        shown = (
            shown_by("Torque at the transducer", "torque [N m]", "bench.shafts.torque"),
            shown_by("Speed at the transducer", "shaft speed [rad/s]", "bench.shafts.speed"),
            shown_by(
                "Current of the machine under test", "current [A]", "bench.electrical.current"
            ),
            shown_by(
                "Voltage of the machine under test", "voltage [V]", "bench.electrical.voltage"
            ),
        )
    else:
        shown = (
            shown_by("Motor torque", "torque [N m]", "motor_states.effort"),
            shown_by("Motor speed", "shaft speed [rad/s]", "motor_states.velocity"),
            each_side(
                vehicle,
                "Current of the motor's circuit",
                "current [A]",
                lambda of: _current(run, vehicle, of),
            ),
            each_side(
                vehicle,
                "Voltage",
                "voltage [V]",
                lambda of: Curve(run.time, channel(run, "battery.voltage")),
            ),
        )
    return dict(zip(OF_A_CIRCUIT, (*shown, efficiency), strict=True))


def electrical(
    run: Recording,
    vehicle: Vehicle,
    driver: Mapping[str, Any],
    chosen: Sequence[str] = OF_A_CIRCUIT,
    side: str = "",
    columns: int = 1,
) -> Sheet:
    """Some of the OF_A_CIRCUIT over the cycle, of both sides or of one: figures 3.1, 3.3 to 3.9 and 5.1 to 5.25."""
    of, wheels = panels(run, vehicle, driver), left_and_right(vehicle)
    shown = [
        each
        for name in chosen
        for wheel, each in zip(wheels, of[name], strict=True)
        if wheel.endswith(side)
    ]
    return over_cycle(shown, run, driver, columns)


def over_friction(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Figures 5.5v to 5.25v: the torques, with the friction of the road under each wheel on an axis of its own."""

    def beside(axes: Axes, wheel: str) -> None:
        friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")
        other = axes.twinx()
        other.step(run.time[::10], friction[::10], where="post", color="0.6", linewidth=0.7)
        other.set_ylim(0.0, 1.05)
        other.set_ylabel("friction [1]")
        other.spines["right"].set_visible(True)
        other.grid(False)

    torques = panels(run, vehicle, driver)["torque"]
    grounds = [partial(beside, wheel=wheel) for wheel in left_and_right(vehicle)]
    return Sheet(
        [replace(each, ground=of) for each, of in zip(torques, grounds, strict=True)], columns=1
    )


def wheel_efficiency(
    run: Recording,
    vehicle: Vehicle,
    driver: Mapping[str, Any],
    wheels: Sequence[str],
    below: Sequence[Panel] = (),
) -> Sheet:
    """Figures 3.2, 3.4 to 3.10: running efficiency (eq 2.37) of wheels over the friction there, and panels below."""
    of_wheels = [
        panel(
            f"Wheel efficiency since the start, {readable(wheel)}",
            "efficiency, friction [1]",
            lambda wheel=wheel: [_wheel_efficiency(run, vehicle, driver, wheel)],
            ends=(0.0, 1.05),
        )
        for wheel in wheels
    ]
    over = [
        replace(each, ground=_friction_below(run, wheel))
        for each, wheel in zip(of_wheels, wheels, strict=True)
    ]
    return Sheet([*over, *below], columns=1)


def _wheel_efficiency(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any], wheel: str
) -> Curve:
    """Eq 2.37 from the start of the cycle up to each sample; a gap where fractions of a turn give nonsense."""
    found = _shares(run, vehicle, wheel).running_efficiency(traction(run, driver))
    return Curve(run.time, np.where((found >= 0.0) & (found <= 1.0), found, np.nan))


def _drive_efficiency(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any], wheel: str
) -> Curve:
    """Eq 2.38 from the start of the cycle up to each sample."""
    found = _shares(run, vehicle, wheel).running_drive_efficiency(traction(run, driver))
    return Curve(run.time, np.where(found >= 0.0, found, np.nan))


def _current(run: Recording, vehicle: Vehicle, wheel: str) -> Curve:
    """What the circuit takes from the battery [A]."""
    period = np.diff(
        run.time, prepend=run.time[0] - 1.0
    )  # the first sample has no period before it
    work = _shares(run, vehicle, wheel).electrical_work
    return Curve(run.time, work / period / channel(run, "battery.voltage"))


def _shares(run: Recording, vehicle: Vehicle, wheel: str) -> CircuitShares:
    shares = circuit_shares(run, vehicle)
    if wheel not in shares:
        raise NotMeasured(f"{readable(wheel)} is not driven")
    return shares[wheel]


def detail(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Some seconds of the first window in which the accelerator is pressed: what the torque control does."""
    try:
        begin = run.time[motion.first(traction(run, driver), "traction")] - 0.5
    except NotMeasured:
        begin = run.time[0]
    part = (run.time >= begin) & (run.time <= begin + DETAIL)
    shorter = Recording(
        run.time[part], {name: values[part] for name, values in run.channels.items()}
    )
    wheels = left_and_right(vehicle)

    def rims() -> list[Curve]:
        named = [(wheel, f"{readable(wheel)} rim") for wheel in wheels]
        curves = [
            Curve(
                shorter.time,
                vehicle.wheel_radius * channel(shorter, f"wheel_states.velocity.{wheel}"),
                label,
            )
            for wheel, label in named
        ]
        return [*curves, Curve(shorter.time, motion.path_speed(shorter), "car")]

    def asked() -> list[Curve]:
        share = channel(shorter, motion.DRIVE_TORQUE) / len(vehicle.driven_wheels)
        return [
            *both_sides(shorter, vehicle, "torque_command.drive"),
            Curve(shorter.time, share, "driver, per wheel"),
        ]

    return Sheet(
        [
            panel("Wheel torque after the torque control", "torque [N m]", asked),
            panel("Speed", "speed [m/s]", rims),
            panel(
                "Slip ratio",
                "slip ratio [1]",
                lambda: both_sides(shorter, vehicle, "tire_forces.slip_ratio"),
                ends=(-0.1, 0.6),  # the first turn of a wheel has any slip
            ),
            panel(
                "Largest friction of the road",
                "friction [1]",
                lambda: both_sides(shorter, vehicle, "tire_forces.friction_coefficient"),
                ends=(0.0, 1.2),
            ),
        ],
        columns=1,
        start=float(shorter.time[0]),
    )


def _friction_below(run: Recording, wheel: str) -> Callable[[Axes], None] | None:
    """Draws the largest friction of the road under a wheel as a ground; None if it was not recorded."""
    try:
        friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")[::10]
    except NotMeasured:
        return None

    def ground(axes: Axes) -> None:
        axes.fill_between(
            run.time[::10],
            friction,
            step="post",
            color="0.87",
            linewidth=0.0,
            label="largest friction",
        )

    return ground
