"""Sheets over an urban cycle, left and right wheels side by side, and the cycle (figure 2.13)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.optional_signals import BenchEnergy
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.profiles.cycle_windows import MODES, TRACTION
from ev_stack.figures.panels import Axes, Curve, Panel, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.handling import surfaces_under
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

# The surfaces that are mixed most often, snow and wet asphalt, differ in lightness, so they do in
# print.
SURFACE_COLOURS = {
    "dry_asphalt": "#1A1A1A",
    "wet_asphalt_1": "#5B6770",
    "wet_asphalt_2": "#8A959C",
    "packed_snow_1": "#CFE8F7",
    "packed_snow_2": "#E6D9F0",
    "ice": "#7BD3EA",
    "dry_asphalt_burckhardt": "#403830",
}
MODE_COLOURS = dict(zip(MODES, ("#F2F2F2", "#F4B183", "#A9D18E"), strict=True))
_SHADE = "#FBF1E8"  # behind curves: that of traction, hardly visible
_STRIP = 0.045  # height of a strip over its width
# Channels and labels of the panels of motors and bench.
_COOLED = (("winding", "winding"), ("inverter", "power stage"), ("coolant_outlet", "coolant out"))
_TORQUES = (
    ("bench.shafts.set_point", "set-point"),
    ("bench.shafts.torque", "measured"),
    ("bench.load_command.torque", "load torque of the road"),
)
_SPEEDS = (("bench.load_command.speed", "set-point"), ("bench.shafts.speed", "measured"))
_TEMPERATURES = (
    ("bench.temperatures.coolant_in", "coolant in"),
    ("bench.temperatures.coolant_out", "coolant out"),
    ("bench.temperatures.load_coolant_out", "load, coolant out"),
    ("bench.temperatures.rotor", "rotor"),
)


def stretches(time: np.ndarray, names: np.ndarray) -> list[tuple[float, float, str]]:
    """Start and end [s] of each stretch with one name, of names (n,) str over time (n,) [s]."""
    changes = np.flatnonzero(names[1:] != names[:-1]) + 1
    edges = [0, *changes.tolist(), len(names) - 1]
    return [
        (float(time[start]), float(time[end]), str(names[start])) for start, end in pairwise(edges)
    ]


def over_cycle(
    panels: Sequence[Panel], run: Recording, driver: Mapping[str, Any], columns: int = 1
) -> Sheet:
    """Panels over the cycle, with a faint ground behind the traction windows of lone curves."""
    try:
        pieces = stretches(run.time, cycle.modes_over_time(run, driver))
    except NotMeasured:
        return Sheet(panels, columns=columns)  # nothing to shade: the panels stand for themselves
    windows = [(start, end - start) for start, end, mode in pieces if mode == MODES[TRACTION]]

    def shade(axes: Axes) -> None:
        axes.broken_barh(
            windows, (0.0, 1.0), transform=axes.get_xaxis_transform(), facecolor=_SHADE, zorder=0
        )

    shaded = [panel if panel.ground else replace(panel, ground=shade) for panel in panels]
    return Sheet(shaded, columns=columns)


def left_and_right(vehicle: Vehicle) -> tuple[str, ...]:
    """The first two driven wheels; the front ones where fewer are driven."""
    if len(vehicle.driven_wheels) < 2:
        return ("front_left", "front_right")
    return vehicle.driven_wheels[:2]


def each_side(
    vehicle: Vehicle, title: str, ylabel: str, *curves: Callable[[str], Curve]
) -> list[Panel]:
    """A panel for the wheel of each side: pulses would hide each other."""
    return [
        panel(
            f"{title}, {readable(wheel)}",
            ylabel,
            lambda wheel=wheel: [curve(wheel) for curve in curves],
        )
        for wheel in left_and_right(vehicle)
    ]


def recorded(
    run: Recording, vehicle: Vehicle, title: str, ylabel: str, *quantities: tuple[str, str]
) -> list[Panel]:
    """Such panels of recorded quantities and their labels."""
    return each_side(
        vehicle,
        title,
        ylabel,
        *(
            lambda at, name=name, label=label: Curve(run.time, channel(run, f"{name}.{at}"), label)
            for name, label in quantities
        ),
    )


def both_sides(run: Recording, vehicle: Vehicle, quantity: str) -> list[Curve]:
    """A quantity of the wheels of both sides, in one panel."""
    return [
        Curve(run.time, channel(run, f"{quantity}.{wheel}"), readable(wheel))
        for wheel in left_and_right(vehicle)
    ]


def cycle_figure(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Figure 2.13: the cycle over time, the surfaces under the wheels, and the windows."""

    def speeds() -> list[Curve]:
        return [
            Curve(run.time, motion.path_speed(run), "driven"),
            Curve(run.time, cycle.wanted_speed(run, driver), "cycle"),
        ]

    under = [
        _strip(
            f"Under the {readable(wheel)} wheel",
            run,
            partial(surfaces_under, run, vehicle, wheel),
            SURFACE_COLOURS,
        )
        for wheel in left_and_right(vehicle)
    ]
    windows = _strip(
        "Windows of the cycle", run, partial(cycle.modes_over_time, run, driver), MODE_COLOURS
    )
    return Sheet(
        [panel("Urban cycle", "speed [m/s]", speeds, ends=(0.0, None)), *under, windows], columns=1
    )


def _strip(
    title: str, run: Recording, names: Callable[[], np.ndarray], colours: Mapping[str, str]
) -> Panel:
    """A strip of colours over time, each named in the legend."""
    try:
        pieces = stretches(run.time, names())
    except NotMeasured as why:
        return Panel(title, "", note=f"not measured: {why}", shape=_STRIP)

    def strip(axes: Axes) -> None:
        for name in dict.fromkeys(name for _, _, name in pieces):
            places = [(start, end - start) for start, end, of in pieces if of == name]
            axes.broken_barh(places, (0.0, 1.0), facecolor=colours[name], label=readable(name))
        axes.set_yticks([])

    return Panel(title, "", ground=strip, ends=(0.0, 1.0), shape=_STRIP)


def motors_and_cells(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Phase quantities of both sides, what warms up, and the mean cell, over a cycle."""

    def temperatures() -> list[Curve]:
        wheel = left_and_right(vehicle)[0]
        return [
            Curve(run.time, channel(run, f"motor_temperatures.{name}.{wheel}"), label)
            for name, label in _COOLED
        ]

    return over_cycle(
        [
            *recorded(
                run, vehicle, "Phase current, rms", "current [A]", ("motor_electrics.current", "")
            ),
            *recorded(
                run, vehicle, "Phase voltage, rms", "voltage [V]", ("motor_electrics.voltage", "")
            ),
            *recorded(
                run, vehicle, "Power from the DC link", "power [W]", ("motor_electrics.power", "")
            ),
            panel(
                "Winding",
                "temperature [degC]",
                lambda: both_sides(run, vehicle, "motor_temperatures.winding"),
            ),
            panel(
                f"Temperatures, {readable(left_and_right(vehicle)[0])}",
                "temperature [degC]",
                temperatures,
            ),
            panel(
                "Cell",
                "voltage [V]",
                lambda: [Curve(run.time, channel(run, "battery.cell.voltage"))],
            ),
            panel(
                "Cell",
                "temperature [degC]",
                lambda: [Curve(run.time, channel(run, "battery.cell.temperature"))],
            ),
        ],
        run,
        driver,
        columns=2,
    )


def bench_channels(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Sheet:
    """Torques and speeds commanded and measured, temperatures, and the accounts of energy."""

    def energies() -> list[Curve]:
        return [
            Curve(run.time, channel(run, f"bench.energy.{name}") / 1e6, name)
            for name in BenchEnergy._fields
        ]

    return over_cycle(
        [
            *recorded(run, vehicle, "Torque at the shaft", "torque [N m]", *_TORQUES),
            *recorded(run, vehicle, "Speed of the shaft", "shaft speed [rad/s]", *_SPEEDS),
            *recorded(run, vehicle, "Temperatures", "temperature [degC]", *_TEMPERATURES),
            panel("Energy since the start", "energy [MJ]", energies),
        ],
        run,
        driver,
        columns=1,
    )
