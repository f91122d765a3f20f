"""The test bench as a method of the role `test_bench`: two machines for each driven wheel.

How it works: each driven wheel has a circuit (`circuit`). In each period it gets the torque of the
law over the gear ratio for the machine under test, and what the plant asks of the load machine.
`outputs` shows all channels at the instant of the state.
"""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any

from ev_bench.inverter.device import InverterParameters, Machine
from ev_bench.inverter.power_stage import coolant_outlet, share_of_lag, winding_temperature
from ev_bench.machines import circuit
from ev_bench.machines.battery_loop import advance_battery, coolant_of_battery
from ev_bench.machines.described import (
    BOTH,
    KEPT_SET_POINTS,
    LEFT,
    RIGHT,
    CircuitsParameters,
    CircuitsState,
    FlowCircuitsParameters,
    FlowCircuitsState,
)
from ev_core.law import (
    BatteryCoolant,
    BenchCoolant,
    BenchElectrical,
    BenchEnergy,
    BenchShafts,
    BenchTemperatures,
    Car,
    LoadCommand,
    Vehicle,
    Wheels,
)
from ev_core.methods.register import method
from ev_core.vehicle.car import any_driven
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.signals import BatteryCondition, WheelTorqueCommand
from ev_msgs_py.refusal import ParameterError

_ROUNDING = 1e-12  # a period of a whole number of steps gets no more than that
_LEAST_VOLTAGE = 1.0  # V, below it a supply is none
CHANNELS = (BenchShafts, BenchElectrical, BenchTemperatures, BenchEnergy)


def prepare(
    parameters: CircuitsParameters, vehicle: Vehicle, period: float
) -> circuit.CircuitsConstants:
    """Compute steps, delays and the machine under test; ParameterError for too long a delay."""
    p = parameters
    steps = max(math.ceil(period / p.step * (1.0 - _ROUNDING)), 1)
    h = period / steps
    for name, path in (("set_point", p.set_point), ("load_set_point", p.load_set_point)):
        # The ring has the present set-point as well, and a delay between two steps needs one more.
        periods = KEPT_SET_POINTS - 2
        longest = periods * period
        if path.delay > longest:
            raise ParameterError(
                f"{name}.delay: {path.delay!r} is refused, expected at most {longest:g} s,"
                f" {periods} control periods"
            )
    motor = {field.name: getattr(vehicle.motor, field.name) for field in fields(Machine)}
    machine = Machine(
        **{**motor, "rotor_inertia": max(vehicle.motor.rotor_inertia, p.least_rotor_inertia)}
    )
    inverter = InverterParameters(machine=machine, thermal=vehicle.motor.thermal)
    return constants(p, inverter, h, steps)


def constants(
    p: CircuitsParameters, machine: InverterParameters, h: float, steps: int
) -> circuit.CircuitsConstants:
    """Constants of a machine under test for steps of a width [s], so many in a control period."""
    delay, load_delay = p.set_point.delay / h, p.load_set_point.delay / h
    lags = (share_of_lag(each.machine.torque_lag, h) for each in (machine, p.load))
    return circuit.CircuitsConstants(h, float(steps), delay, load_delay, *lags, machine)


@compilable
def outputs(
    p: CircuitsParameters, car: Car, c: circuit.CircuitsConstants, s: CircuitsState
) -> tuple[BenchShafts, BenchElectrical, BenchTemperatures, BenchEnergy]:
    """All channels at the instant of the state: the one way out of the bench."""
    n = s.circuits
    shafts = BenchShafts(
        Wheels(
            n[0].torque_path.now, n[1].torque_path.now, n[2].torque_path.now, n[3].torque_path.now
        ),
        Wheels(n[0].mean_torque, n[1].mean_torque, n[2].mean_torque, n[3].mean_torque),
        Wheels(
            n[0].mean_shaft_torque,
            n[1].mean_shaft_torque,
            n[2].mean_shaft_torque,
            n[3].mean_shaft_torque,
        ),
        Wheels(n[0].speed, n[1].speed, n[2].speed, n[3].speed),
        Wheels(
            n[0].mean_load_torque,
            n[1].mean_load_torque,
            n[2].mean_load_torque,
            n[3].mean_load_torque,
        ),
        Wheels(n[0].load_speed, n[1].load_speed, n[2].load_speed, n[3].load_speed),
    )
    # Currents are powers over voltages, which at a dead supply would be 0/0.
    u, mains = max(s.voltage, _LEAST_VOLTAGE), p.load.dc_link.supply_voltage
    driven = Wheels(car.driven[0], car.driven[1], car.driven[2], car.driven[3])
    electrical = BenchElectrical(
        Wheels(driven[0] * u, driven[1] * u, driven[2] * u, driven[3] * u),
        Wheels(driven[0] * mains, driven[1] * mains, driven[2] * mains, driven[3] * mains),
        Wheels(n[0].power / u, n[1].power / u, n[2].power / u, n[3].power / u),
        Wheels(
            n[0].load_power / mains,
            n[1].load_power / mains,
            n[2].load_power / mains,
            n[3].load_power / mains,
        ),
    )
    return shafts, electrical, _temperatures(p, c, s, driven), _energy(p, c, s)


@compilable
def _temperatures(
    p: CircuitsParameters, c: circuit.CircuitsConstants, s: CircuitsState, driven: Wheels
) -> BenchTemperatures:
    """Coolant of both machines and the rotor (figure 4.9), which is as warm as the winding.

    Places without a circuit are at 0 degC.
    """
    n, thermal, load = s.circuits, c.machine.thermal, p.load.thermal
    cold, load_cold = thermal.coolant, load.coolant
    return BenchTemperatures(
        Wheels(driven[0] * cold, driven[1] * cold, driven[2] * cold, driven[3] * cold),
        Wheels(
            driven[0] * coolant_outlet(thermal, n[0].machine),
            driven[1] * coolant_outlet(thermal, n[1].machine),
            driven[2] * coolant_outlet(thermal, n[2].machine),
            driven[3] * coolant_outlet(thermal, n[3].machine),
        ),
        Wheels(
            driven[0] * load_cold,
            driven[1] * load_cold,
            driven[2] * load_cold,
            driven[3] * load_cold,
        ),
        Wheels(
            driven[0] * coolant_outlet(load, n[0].load),
            driven[1] * coolant_outlet(load, n[1].load),
            driven[2] * coolant_outlet(load, n[2].load),
            driven[3] * coolant_outlet(load, n[3].load),
        ),
        Wheels(
            driven[0] * winding_temperature(thermal, n[0].machine),
            driven[1] * winding_temperature(thermal, n[1].machine),
            driven[2] * winding_temperature(thermal, n[2].machine),
            driven[3] * winding_temperature(thermal, n[3].machine),
        ),
    )


@compilable
def _energy(p: CircuitsParameters, c: circuit.CircuitsConstants, s: CircuitsState) -> BenchEnergy:
    """Sums over the circuits, left and right first."""
    battery = mains = resistor = machines = loads = shafts = stored = 0.0
    for axle in range(2):
        left, right = s.circuits[2 * axle], s.circuits[2 * axle + 1]
        battery += left.battery + right.battery
        mains += left.mains + right.mains
        resistor += left.resistor + right.resistor
        machines += left.machine_heat + right.machine_heat
        loads += left.load_heat + right.load_heat
        shafts += left.shaft_heat + right.shaft_heat
        stored += circuit.stored_energy(p, c, left) + circuit.stored_energy(p, c, right)
    return BenchEnergy(battery, mains, resistor, machines, loads, shafts, stored)


CIRCUITS: dict[str, Any] = {
    "state": CircuitsState,
    "prepare": prepare,
    "needs": (any_driven,),
    "requires": {"plant": "planar_on_bench"},
    "mirrored": True,
}


@method("test_bench", "circuits", outputs=outputs, writes=CHANNELS, **CIRCUITS)
@compilable
def circuits(
    p: CircuitsParameters,
    car: Car,
    c: circuit.CircuitsConstants,
    s: CircuitsState,
    period: float,
    command: WheelTorqueCommand,
    load: LoadCommand,
    battery: BatteryCondition,
) -> None:
    """Motors of the car on shafts with load machine and transducer (dissertation, chapter 4).

    The machine under test follows the torque that the laws ask for, the load machine what the
    virtual car asks for.
    """
    s.voltage = battery.voltage
    for i in range(4):
        if car.driven[i] == 1.0:
            enabled = p.enabled == BOTH or p.enabled == (LEFT if i % 2 == 0 else RIGHT)
            circuit.power(s.circuits[i], enabled, battery.voltage, p.load.dc_link.supply_voltage)
            shaft_torque = command.drive[i] / car.gear_ratio  # section 4.1
            given = circuit.CircuitSetPoint(
                shaft_torque, load.mode[i], load.torque[i], load.speed[i]
            )
            circuit.advance_circuit(p, c, s.circuits[i], s.periods, given, period)
    s.periods += 1.0


@compilable
def outputs_with_flow(
    p: FlowCircuitsParameters, car: Car, c: circuit.CircuitsConstants, s: FlowCircuitsState
) -> tuple[
    BenchShafts, BenchElectrical, BenchTemperatures, BenchEnergy, BenchCoolant, BatteryCoolant
]:
    """Channels of `circuits`, and those of the coolant loops: no flow without cooling."""
    shafts, electrical, temperatures, energy = outputs(p, car, c, s)
    flow, load_flow = (
        p.cooling * c.machine.thermal.coolant_flow,
        p.cooling * p.load.thermal.coolant_flow,
    )
    n = car.driven
    coolant = BenchCoolant(
        Wheels(n[0] * flow, n[1] * flow, n[2] * flow, n[3] * flow),
        Wheels(n[0] * load_flow, n[1] * load_flow, n[2] * load_flow, n[3] * load_flow),
    )
    of_battery = coolant_of_battery(p.battery_loop, car, s.battery_loop, p.cooling)
    return shafts, electrical, temperatures, energy, coolant, of_battery


@method(
    "test_bench",
    "circuits_with_flow",
    outputs=outputs_with_flow,
    writes=(*CHANNELS, BenchCoolant, BatteryCoolant),
    **{**CIRCUITS, "state": FlowCircuitsState},
)
@compilable
def circuits_with_flow(
    p: FlowCircuitsParameters,
    car: Car,
    c: circuit.CircuitsConstants,
    s: FlowCircuitsState,
    period: float,
    command: WheelTorqueCommand,
    load: LoadCommand,
    battery: BatteryCondition,
) -> None:
    """Circuits with the sensors of their coolant loops and of the battery's (section 4.2)."""
    circuits(p, car, c, s, period, command, load, battery)
    power = 0.0
    for i in range(4):
        power += s.circuits[i].power
    current = power / max(s.voltage, _LEAST_VOLTAGE)
    advance_battery(p.battery_loop, car, s.battery_loop, p.cooling, current, period)
