"""Channels over the cycle: those of motors, inverters and cells, and those of the test bench."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.optional_signals import BenchEnergy
from ev_papers.dissertation.figures.urban_sheets import both_sides, each_side, left_and_right, sheet_over_cycle
from ev_sim.figures.figure import Figure
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording

_COOLED = (("winding", "winding"), ("inverter", "power stage"), ("coolant_outlet", "coolant out"))


def motors_and_cells(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Phase quantities of both sides, what warms up, and the mean cell, over a cycle."""

    def temperatures() -> list[Curve]:
        wheel = left_and_right(vehicle)[0]
        return [Curve(run.time, channel(run, f"motor_temperatures.{name}.{wheel}"), label) for name, label in _COOLED]

    return sheet_over_cycle(
        [
            *each_side(run, vehicle, "Phase current, rms", "current [A]", "motor_electrics.current"),
            *each_side(run, vehicle, "Phase voltage, rms", "voltage [V]", "motor_electrics.voltage"),
            *each_side(run, vehicle, "Power from the DC link", "power [W]", "motor_electrics.power"),
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

    def sides(title: str, ylabel: str, channels: Sequence[tuple[str, str]]) -> list[Panel]:
        return [
            panel(
                f"{title}, {wheel.replace('_', ' ')}",
                ylabel,
                lambda wheel=wheel: [Curve(run.time, channel(run, f"{name}.{wheel}"), said) for name, said in channels],
            )
            for wheel in left_and_right(vehicle)
        ]

    def energies() -> list[Curve]:
        return [Curve(run.time, channel(run, f"bench.energy.{name}") / 1e6, name) for name in BenchEnergy._fields]

    return sheet_over_cycle(
        [
            *sides("Torque at the shaft", "torque [N m]", _TORQUES),
            *sides("Speed of the shaft", "speed [rad/s]", _SPEEDS),
            *sides("Temperatures", "temperature [degC]", _TEMPERATURES),
            panel("Energy since the start", "energy [MJ]", energies),
        ],
        run,
        driver,
        columns=1,
    )
