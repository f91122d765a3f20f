"""Sheets over a whole urban cycle, left and right wheels side by side; the cycle itself (figure 2.13)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.optional_signals import BenchEnergy
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.figures.drawing import (
    DPI,
    STROKES,
    TEXT_SIZE,
    Axes,
    Curve,
    Figure,
    Panel,
    name_axes,
    new_figure,
    panel,
    sheet,
    thinned,
)
from ev_sim.measures import motion
from ev_sim.measures.handling import surfaces_under
from ev_sim.measures.metric import NotMeasured, channel
from ev_sim.profiles.cycle_windows import MODES, TRACTION
from ev_sim.recording.recording import Recording

# The surfaces that are mixed most often, snow and wet asphalt, differ in lightness, so they do in print.
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


def stretches(time: np.ndarray, names: np.ndarray) -> list[tuple[float, float, str]]:
    """Start and end [s] of each stretch with one name, of names (n,) str over time (n,) [s]."""
    changes = np.flatnonzero(names[1:] != names[:-1]) + 1
    edges = [0, *changes.tolist(), len(names) - 1]
    return [(float(time[a]), float(time[b]), str(names[a])) for a, b in pairwise(edges)]


def draw_strip(axes: Axes, pieces: Sequence[tuple[float, float, str]], colours: Mapping[str, str], name: str) -> None:
    """A strip of colours over time, its name in place of an ordinate."""
    axes.broken_barh(
        [(start, end - start) for start, end, _ in pieces],
        (0.0, 1.0),
        facecolors=[colours[piece] for _, _, piece in pieces],
        linewidth=0.0,
    )
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.set_ylabel(name, rotation="horizontal", ha="right", va="center", fontsize=8.0)


def shade_traction(figure: Figure, pieces: Sequence[tuple[float, float, str]]) -> None:
    """A faint ground behind the traction windows in all axes of a figure over time."""
    for axes in figure.axes:
        limits = axes.get_xlim()
        for start, end, mode in pieces:
            if mode == MODES[TRACTION]:
                axes.axvspan(start, end, facecolor=_SHADE, edgecolor="none", zorder=0)
        axes.set_xlim(limits)


SHEET_WIDTH, NARROW = 9.2, 6.2  # of a panel alone, and of one beside another [inch]
TIME_AXIS = "time [s]"


def thin_sheet(panels: list[Panel], columns: int = 1) -> Figure:
    """A sheet whose curves are thin enough for the pulses of a whole cycle."""
    figure = sheet(panels, TIME_AXIS, columns=columns, panel_width=SHEET_WIDTH if columns == 1 else NARROW)
    for line in (line for axes in figure.axes for line in axes.lines):
        line.set_linewidth(0.7)
    return figure


def sheet_over_cycle(panels: list[Panel], run: Recording, driver: Mapping[str, Any], columns: int = 1) -> Figure:
    """The same with the traction windows behind the curves."""
    figure = thin_sheet(panels, columns)
    try:
        shade_traction(figure, stretches(run.time, cycle.modes_over_time(run, driver)))
    except NotMeasured:
        return figure  # nothing to shade: the panels stand for themselves
    return figure


def left_and_right(vehicle: Vehicle) -> tuple[str, ...]:
    """The first two driven wheels; the front ones where fewer are driven."""
    return vehicle.driven_wheels[:2] if len(vehicle.driven_wheels) > 1 else ("front_left", "front_right")


def each_side(vehicle: Vehicle, title: str, ylabel: str, *curves: Callable[[str], Curve]) -> list[Panel]:
    """A panel for the wheel of each side: pulses would hide each other."""
    return [
        panel(f"{title}, {wheel.replace('_', ' ')}", ylabel, lambda wheel=wheel: [curve(wheel) for curve in curves])
        for wheel in left_and_right(vehicle)
    ]


def recorded(run: Recording, vehicle: Vehicle, title: str, ylabel: str, *quantities: tuple[str, str]) -> list[Panel]:
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
        Curve(run.time, channel(run, f"{quantity}.{wheel}"), wheel.replace("_", " "))
        for wheel in left_and_right(vehicle)
    ]


def cycle_figure(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Figure 2.13: the cycle over time, what lies under the wheels, and the windows."""
    figure = new_figure(SHEET_WIDTH, 4.2)
    rows = figure.subplots(4, 1, sharex=True, height_ratios=(8, 1, 1, 1))
    figure.subplots_adjust(left=0.085, right=0.985, bottom=0.2, top=0.94, hspace=0.16)
    speed, *strips = rows
    _draw_speed(speed, run, driver)
    shown: dict[str, str] = {}
    for axes, wheel in zip(strips[:2], left_and_right(vehicle), strict=True):
        _strip(axes, run, lambda wheel=wheel: surfaces_under(run, vehicle, wheel), SURFACE_COLOURS, wheel, shown)
    _strip(strips[2], run, lambda: cycle.modes_over_time(run, driver), MODE_COLOURS, "window", shown)
    for axes in rows:
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
    strips[2].set_xlabel(TIME_AXIS, fontsize=TEXT_SIZE)
    strips[2].set_xlim(run.time[0], run.time[-1])
    from matplotlib.patches import Patch

    patches = [Patch(facecolor=colour, edgecolor="0.6", linewidth=0.5, label=name) for name, colour in shown.items()]
    if patches:
        figure.legend(handles=patches, loc="lower center", ncols=len(patches), fontsize=TEXT_SIZE, frameon=False)
    return figure


def _draw_speed(axes: Axes, run: Recording, driver: Mapping[str, Any]) -> None:
    curves = (
        ("driven", STROKES[1][0], 0.8, lambda: motion.path_speed(run)),
        ("cycle", STROKES[0][0], 1.2, lambda: cycle.wanted_speed(run, driver)),
    )
    missing = []
    for label, colour, width, values in curves:
        try:
            axes.plot(*thinned(run.time, values(), int(SHEET_WIDTH * DPI)), color=colour, linewidth=width, label=label)
        except NotMeasured as why:
            missing.append(f"{label} not measured: {why}")
    if missing:
        axes.text(0.5, 0.5, "\n".join(missing), transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE, color="0.4")
    name_axes(axes, "Urban cycle and what lies under the wheels", ylabel="speed [m/s]")
    axes.set_ylim(bottom=0.0)
    if axes.lines:
        axes.legend(loc="upper right", bbox_to_anchor=(1.0, 1.1), ncols=2, fontsize=TEXT_SIZE, frameon=False)


def _strip(
    axes: Axes,
    run: Recording,
    names: Callable[[], np.ndarray],
    colours: Mapping[str, str],
    label: str,
    shown: dict[str, str],
) -> None:
    """Draw a strip and note which colours it shows, by the words of the legend."""
    try:
        pieces = stretches(run.time, names())
    except NotMeasured as why:
        pieces = []
        axes.text(0.5, 0.3, f"not measured: {why}", transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE)
    draw_strip(axes, pieces, colours, label.replace("_", " "))
    present = {piece for _, _, piece in pieces}
    shown.update({name.replace("_", " "): colour for name, colour in colours.items() if name in present})


_COOLED = (("winding", "winding"), ("inverter", "power stage"), ("coolant_outlet", "coolant out"))


def motors_and_cells(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Phase quantities of both sides, what warms up, and the mean cell, over a cycle."""

    def temperatures() -> list[Curve]:
        wheel = left_and_right(vehicle)[0]
        return [Curve(run.time, channel(run, f"motor_temperatures.{name}.{wheel}"), label) for name, label in _COOLED]

    return sheet_over_cycle(
        [
            *recorded(run, vehicle, "Phase current, rms", "current [A]", ("motor_electrics.current", "")),
            *recorded(run, vehicle, "Phase voltage, rms", "voltage [V]", ("motor_electrics.voltage", "")),
            *recorded(run, vehicle, "Power from the DC link", "power [W]", ("motor_electrics.power", "")),
            panel("Winding", "temperature [degC]", lambda: both_sides(run, vehicle, "motor_temperatures.winding")),
            panel(f"Temperatures, {left_and_right(vehicle)[0].replace('_', ' ')}", "temperature [degC]", temperatures),
            panel("Cell", "voltage [V]", lambda: [Curve(run.time, channel(run, "battery.cell.voltage"))]),
            panel("Cell", "temperature [degC]", lambda: [Curve(run.time, channel(run, "battery.cell.temperature"))]),
        ],
        run,
        driver,
        columns=2,
    )


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


def bench_channels(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Torques and speeds commanded and measured, temperatures of both circuits, and the accounts of energy."""

    def energies() -> list[Curve]:
        return [Curve(run.time, channel(run, f"bench.energy.{name}") / 1e6, name) for name in BenchEnergy._fields]

    return sheet_over_cycle(
        [
            *recorded(run, vehicle, "Torque at the shaft", "torque [N m]", *_TORQUES),
            *recorded(run, vehicle, "Speed of the shaft", "speed [rad/s]", *_SPEEDS),
            *recorded(run, vehicle, "Temperatures", "temperature [degC]", *_TEMPERATURES),
            panel("Energy since the start", "energy [MJ]", energies),
        ],
        run,
        driver,
        columns=1,
    )
