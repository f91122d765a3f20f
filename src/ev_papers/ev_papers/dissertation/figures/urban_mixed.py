"""Figures of a run of the urban cycle on mixed surfaces, like 3.1 to 3.10 and 5.1 to 5.25."""

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
from ev_papers.dissertation.measures.traction_windows import traction
from ev_stack.figures.panels import Axes, Curve, Panel, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

DETAIL = 15.0  # [s], length of the figure in which single pulses can be seen
# Quantities of a circuit, in the order of the figures of chapter 5.
OF_A_CIRCUIT = ("torque", "speed", "current", "voltage", "drive efficiency")


def panels(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, list[Panel]]:
    """Panels of each of OF_A_CIRCUIT, left and right; on a test bench by its transducers.

    One battery feeds both circuits, so without a bench both have its voltage. The efficiency is
    that of eq 2.38.
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
    """Panels of OF_A_CIRCUIT over the cycle, both sides or one (3.1, 3.3 to 3.9, 5.1 to 5.25)."""
    of = panels(run, vehicle, driver)
    shown = []
    for name in chosen:
        for wheel, each in zip(left_and_right(vehicle), of[name], strict=True):
            if wheel.endswith(side):
                shown.append(each)
    return over_cycle(shown, run, driver, columns)


def over_friction(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Torques, with the friction under each wheel on an axis of its own (figures 5.5v to 5.25v)."""

    def beside(axes: Axes, wheel: str) -> None:
        friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")
        other = axes.twinx()
        other.step(run.time[::10], friction[::10], where="post", color="0.6", linewidth=0.7)
        other.set_ylim(0.0, 1.05)
        other.set_ylabel("friction [1]")
        other.spines["right"].set_visible(True)
        other.grid(False)

    torques = panels(run, vehicle, driver)["torque"]
    shown = []
    for wheel, each in zip(left_and_right(vehicle), torques, strict=True):
        shown.append(replace(each, ground=partial(beside, wheel=wheel)))
    return Sheet(shown, columns=1)


def wheel_efficiency(
    run: Recording,
    vehicle: Vehicle,
    driver: Mapping[str, Any],
    wheels: Sequence[str],
    below: Sequence[Panel] = (),
) -> Sheet:
    """Running efficiency (eq 2.37) of wheels over the friction there (figures 3.2, 3.4 to 3.10)."""

    def of(wheel: str) -> Panel:
        shown = panel(
            f"Wheel efficiency since the start, {readable(wheel)}",
            "efficiency, friction [1]",
            lambda: [_wheel_efficiency(run, vehicle, driver, wheel)],
            ends=(0.0, 1.05),
        )
        return replace(shown, ground=_friction_below(run, wheel))

    return Sheet([*map(of, wheels), *below], columns=1)


def _wheel_efficiency(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any], wheel: str
) -> Curve:
    """Eq 2.37 from the start of the cycle up to each sample."""
    found = _shares(run, vehicle, wheel).running_efficiency(traction(run, driver))
    # A gap where fractions of a turn give nonsense.
    return Curve(run.time, np.where((found >= 0.0) & (found <= 1.0), found, np.nan))


def _drive_efficiency(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any], wheel: str
) -> Curve:
    """Eq 2.38 from the start of the cycle up to each sample."""
    found = _shares(run, vehicle, wheel).running_drive_efficiency(traction(run, driver))
    return Curve(run.time, np.where(found >= 0.0, found, np.nan))


def _current(run: Recording, vehicle: Vehicle, wheel: str) -> Curve:
    """Current of the circuit from the battery [A]."""
    # The first sample has no period before it.
    period = np.diff(run.time, prepend=run.time[0] - 1.0)
    work = _shares(run, vehicle, wheel).electrical_work
    return Curve(run.time, work / period / channel(run, "battery.voltage"))


def _shares(run: Recording, vehicle: Vehicle, wheel: str) -> CircuitShares:
    shares = circuit_shares(run, vehicle)
    if wheel not in shares:
        raise NotMeasured(f"{readable(wheel)} is not driven")
    return shares[wheel]


def detail(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Torque control in some seconds of the first window with the accelerator pressed."""
    try:
        begin = run.time[motion.first(traction(run, driver), "traction")] - 0.5
    except NotMeasured:
        begin = run.time[0]
    part = (run.time >= begin) & (run.time <= begin + DETAIL)
    channels = {name: values[part] for name, values in run.channels.items()}
    shorter = Recording(run.time[part], channels)
    wheels = left_and_right(vehicle)

    def rims() -> list[Curve]:
        curves = []
        for wheel in wheels:
            speed = vehicle.wheel_radius * channel(shorter, f"wheel_states.velocity.{wheel}")
            curves.append(Curve(shorter.time, speed, f"{readable(wheel)} rim"))
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
    """Ground with the largest friction of the road under a wheel; None if it was not recorded."""
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
