"""Channels of the test bench over the cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ev_msgs_py.contract.bench_signals import BenchEnergy
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.figures.urban_sheets import left_and_right, sheet_over_cycle
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording

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
