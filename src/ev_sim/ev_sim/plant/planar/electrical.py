"""The electrical side of the planar plant, in `planar_electrical` only: limits by voltage and temperature, heat."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import exp, expm1
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.drives.field_weakening import voltage_limited_torque, weakening_loss
from ev_sim.drives.temperatures import derating_share, heated
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.state import PlanarState


class Electrical(NamedTuple):
    """Zeros where it is not modelled."""

    modelled: float = 0.0  # 1 where it is
    # Temperatures [degC] between which cells may be discharged and charged, see `cells.temperature_share`.
    discharge_temperature: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    charge_temperature: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    relaxation_resistance: float = 0.0  # of the battery [ohm]
    relaxation_share: float = 0.0  # what relaxation closes over a step [1]
    # What a step leaves of a difference of temperature [1].
    cells_left: float = 0.0
    winding_left: float = 0.0
    inverter_left: float = 0.0


def electrical_over(h: float, vehicle: Vehicle) -> Electrical:
    """The constants for steps of h [s]."""
    cells, thermal = vehicle.battery.cells, vehicle.motor.thermal
    return Electrical(
        modelled=1.0,
        discharge_temperature=cells.discharge_temperature,
        charge_temperature=cells.charge_temperature,
        relaxation_resistance=cells.in_series * cells.relaxation_resistance,
        relaxation_share=-expm1(-h / cells.relaxation_time),
        cells_left=exp(-h / (cells.heat_capacity * cells.thermal_resistance)),
        winding_left=exp(-h / (thermal.winding_capacity * thermal.winding_resistance)),
        inverter_left=exp(-h / (thermal.inverter_capacity * thermal.inverter_resistance)),
    )


@inlined
def within_electrical_limits(s: PlanarState, car: Car, i: int, torque: float, voltage: float, speed: float) -> float:
    """The torque [N m] of the motor of wheel i that voltage [V] and temperatures leave at a shaft speed [rad/s]."""
    thermal = car.motor.thermal
    winding, inverter = thermal.coolant + s.winding_rise[i], thermal.coolant + s.inverter_rise[i]
    most = voltage_limited_torque(car.motor.winding, voltage, speed)
    most = min(most, car.motor.peak_torque * derating_share(thermal, winding, inverter))
    return min(max(torque, -most), most)


@inlined
def heat_motors(s: PlanarState, car: Car, c: Electrical, step: Step) -> None:
    """Heat windings by the copper loss of this step, power stages by what grows with the torque."""
    motor = car.motor
    for i in range(4):
        torque, speed = step.motor[i], step.shaft[i] * car.gear[i]
        copper = motor.copper_loss * torque * torque * car.driven[i]
        if car.driven[i] == 1.0:
            copper += weakening_loss(motor, torque, step.voltage, speed)
        stage = motor.inverter_torque_loss * abs(torque)
        s.winding_rise[i] = heated(s.winding_rise[i], copper, motor.thermal.winding_resistance, c.winding_left)
        s.inverter_rise[i] = heated(s.inverter_rise[i], stage, motor.thermal.inverter_resistance, c.inverter_left)


@inlined
def heat_cells(s: PlanarState, car: Car, c: Electrical, resistance: float, current: float) -> None:
    """Heat the cells by a current [A] through the resistance [ohm] of the string, and by their relaxation."""
    cells = car.battery.cells
    heat = resistance * current * current
    if c.relaxation_resistance > 0.0:
        heat += s.relaxation * s.relaxation / c.relaxation_resistance
    s.cells_rise = heated(s.cells_rise, heat / cells.in_series, cells.thermal_resistance, c.cells_left)
