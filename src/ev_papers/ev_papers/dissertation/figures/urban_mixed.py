"""Figures of the urban cycle on mixed surfaces, like the dissertation's 2.13, 3.1 to 3.10 and 5.1 to 5.25."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.figures.circuit_curves import (
    circuit_current,
    running_drive_efficiency,
    running_wheel_efficiency,
)
from ev_papers.dissertation.figures.urban_sheets import (
    TIME,
    WIDTH,
    both_sides,
    each_side,
    left_and_right,
    sheet_over_cycle,
    thin_sheet,
)
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.figures.drawing import sheet
from ev_sim.figures.figure import Axes, Figure
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures import motion
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording

DETAIL = 15.0  # [s], length of the figure in which single pulses can be seen


def torques_and_speeds(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Figures 3.1, 3.3, 3.5, 3.7 and 3.9: torques and speeds at the shafts of the motors, left and right."""
    return sheet_over_cycle(
        [
            *each_side(run, vehicle, "Motor torque", "torque [N m]", "motor_states.effort"),
            *each_side(run, vehicle, "Motor speed", "speed [rad/s]", "motor_states.velocity"),
        ],
        run,
        driver,
    )


def wheel_efficiency(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Figures 3.2, 3.4, 3.6, 3.8 and 3.10: running wheel efficiency over the friction under the wheel, and torques."""
    wheels = left_and_right(vehicle)
    figure = thin_sheet(
        [
            *(
                panel(
                    f"Wheel efficiency since the start, {wheel.replace('_', ' ')} (grey: largest friction of the road)",
                    "efficiency, friction [1]",
                    lambda wheel=wheel: [running_wheel_efficiency(run, vehicle, driver, wheel)],
                )
                for wheel in wheels
            ),
            *each_side(run, vehicle, "Motor torque", "torque [N m]", "motor_states.effort"),
        ],
    )
    for axes, wheel in zip(figure.axes, wheels, strict=False):
        lay_over_friction(axes, run, wheel)
    return figure


def detail(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Some seconds of the first window in which the accelerator is pressed: what the torque control does."""
    try:
        begin = run.time[motion.first(cycle.traction(run, driver), "traction")] - 0.5
    except NotMeasured:
        begin = run.time[0]
    part = (run.time >= begin) & (run.time <= begin + DETAIL)
    shorter = Recording(run.time[part], {name: values[part] for name, values in run.channels.items()})
    wheels = left_and_right(vehicle)

    def rims() -> list[Curve]:
        named = [(wheel, f"{wheel.replace('_', ' ')} rim") for wheel in wheels]
        curves = [
            Curve(shorter.time, vehicle.wheel_radius * channel(shorter, f"wheel_states.velocity.{wheel}"), label)
            for wheel, label in named
        ]
        return [*curves, Curve(shorter.time, motion.path_speed(shorter), "car")]

    def asked() -> list[Curve]:
        share = channel(shorter, motion.DRIVE_TORQUE) / len(vehicle.driven_wheels)
        return [
            *both_sides(shorter, vehicle, "torque_command.drive"),
            Curve(shorter.time, share, "driver, per wheel"),
        ]

    figure = sheet(
        [
            panel("Wheel torque after the torque control", "torque [N m]", asked),
            panel("Speed", "speed [m/s]", rims),
            panel("Slip ratio", "slip ratio [1]", lambda: both_sides(shorter, vehicle, "tire_forces.slip_ratio")),
            panel(
                "Largest friction of the road",
                "friction [1]",
                lambda: both_sides(shorter, vehicle, "tire_forces.friction_coefficient"),
            ),
        ],
        TIME,
        columns=1,
        start=float(shorter.time[0]),
        panel_width=WIDTH,
    )
    figure.axes[2].set_ylim(-0.1, 0.6)  # the first turn of a wheel has any slip
    figure.axes[3].set_ylim(0.0, 1.2)
    return figure


def electrical(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Figures 5.1 to 5.25: torques, speeds, currents and voltages of both circuits, and their efficiency (eq 2.38).

    One battery feeds both circuits, so both have its voltage.
    """

    def sides(title: str, ylabel: str, curve: Callable[[str], Curve]) -> list[Panel]:
        return [
            panel(f"{title}, {wheel.replace('_', ' ')}", ylabel, lambda wheel=wheel: [curve(wheel)])
            for wheel in left_and_right(vehicle)
        ]

    figure = sheet_over_cycle(
        [
            *each_side(run, vehicle, "Motor torque", "torque [N m]", "motor_states.effort"),
            *each_side(run, vehicle, "Motor speed", "speed [rad/s]", "motor_states.velocity"),
            *sides("Current of the motor's circuit", "current [A]", lambda wheel: circuit_current(run, vehicle, wheel)),
            *sides("Voltage", "voltage [V]", lambda wheel: Curve(run.time, channel(run, "battery.voltage"))),
            *sides(
                "Drive efficiency in the traction windows since the start",
                "efficiency [1]",
                lambda wheel: running_drive_efficiency(run, vehicle, driver, wheel),
            ),
        ],
        run,
        driver,
        columns=2,
    )
    for axes in figure.axes[-2:]:
        axes.set_ylim(0.5, 1.0)
    return figure


def lay_over_friction(axes: Axes, run: Recording, wheel: str) -> None:
    """The largest friction of the road under a wheel as a ground of its efficiency, whose curves become bolder."""
    axes.set_ylim(0.0, 1.05)
    for line in axes.lines:
        line.set_linewidth(1.5)
    try:
        friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")
    except NotMeasured:
        return
    axes.fill_between(run.time[::10], friction[::10], step="post", color="0.87", linewidth=0.0, zorder=1)
