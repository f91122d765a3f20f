"""The planar plant with its electrical side: energy, heat, limits by voltage and temperature."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.compiled_object import CompiledObject
from plant.planar.car import STRAIGHT, command, drive, outputs, plant

from ev_core.vehicle.battery import Battery, Cells
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor, ThermalParameters
from ev_msgs_py.contract.optional_signals import CellCondition, MotorElectrics, MotorTemperatures
from ev_msgs_py.contract.signals import BatteryCondition, MotorStates
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.synchronous_motor import voltage_limited_torque
from ev_sim.plant.planar.planar_state import index

GEAR = 7.4
FAST = 40.0  # m/s: the shaft turns with about 1000 rad/s
MOTOR = Motor(
    peak_torque=360.0, nominal_torque=250.0, peak_power=150e3, generator_torque=250.0, generator_power=85e3,
    maximum_speed=2000.0, copper_loss=0.045,
)  # fmt: skip
BATTERY = Battery(cells=Cells(in_series=206), discharge_power=1e6, charge_power=1e6)
CAR = Vehicle(gear_ratio=GEAR, mass=2000.0, motor=MOTOR, battery=BATTERY)


def electrical(car: Vehicle = CAR, period: float = 0.01, **parameters) -> CompiledObject:
    return plant(car, period, electrical=True, **parameters)


def with_thermal(**values: float) -> Vehicle:
    return dataclasses.replace(
        CAR, motor=dataclasses.replace(MOTOR, thermal=ThermalParameters(**values))
    )


def with_cells(**values) -> Vehicle:
    cells = dataclasses.replace(BATTERY.cells, **values)
    return dataclasses.replace(CAR, battery=dataclasses.replace(BATTERY, cells=cells))


@pytest.mark.parametrize("speed", [5.0, FAST])
@pytest.mark.parametrize("torque", [600.0, -600.0])
def test_electrical_power_is_mechanical_power_and_losses(speed, torque):
    """The battery gives what the inverters take, at held speed, with and without weakened field.

    1e-6, because voltage and current of the battery are single precision numbers, and because over
    1 ms its voltage, and with it the weakening current, hardly moves.
    """
    car = electrical(period=1e-3, speed="held", initial_speed=speed)
    drive(car, 10.0, Wheels.front(torque, torque))  # of 10 ms each, so 1 s
    before = car.state.copy()
    out = drive(car, 0.01, Wheels.front(torque, torque))
    power = sum(out[MotorElectrics].power)
    assert -out[BatteryCondition].voltage * out[BatteryCondition].current == pytest.approx(
        power, rel=1e-6
    )
    moved = {
        name: car.state[index(name)] - before[index(name)]
        for name in ("battery_work", "motor_loss", "driveline_loss", "drive_work")
    }
    used = moved["motor_loss"] + moved["driveline_loss"] + moved["drive_work"]
    assert moved["battery_work"] == pytest.approx(used, rel=1e-9)
    assert moved["battery_work"] == pytest.approx(power * 1e-3, rel=1e-6)
    mechanical = sum(
        v * t for v, t in zip(out[MotorStates].velocity, out[MotorStates].effort, strict=True)
    )
    assert moved["motor_loss"] == pytest.approx((power - mechanical) * 1e-3, abs=1e-9 * abs(power))


def test_the_winding_takes_the_copper_loss_and_ends_at_the_closed_form():
    """T = T_coolant + R k_c M^2, the inverter T_coolant + R k_t M.

    The coolant carries both away, m c dT = P.

    20 time constants leave 2e-9 of the difference.
    """
    car = electrical(
        with_thermal(winding_capacity=20.0, inverter_capacity=10.0), speed="held", initial_speed=5.0
    )  # time constants of 0.3 s and 0.2 s
    out = drive(car, 6.0, Wheels.front(100.0 * GEAR, 100.0 * GEAR))
    seen = out[MotorTemperatures]
    copper, stage = 0.045 * 100.0**2, MOTOR.inverter_torque_loss * 100.0
    assert seen.winding.front_left == pytest.approx(40.0 + 0.015 * copper, rel=1e-8)
    assert seen.inverter.front_left == pytest.approx(40.0 + 0.02 * stage, rel=1e-8)
    flow = seen.coolant_flow.front_left / 60e3 * 1060.0 * 3500.0  # W/K
    assert seen.coolant_outlet.front_left == pytest.approx(40.0 + (copper + stage) / flow, rel=1e-8)
    assert seen.winding.rear_left == 0.0, "no motor there"
    first = electrical(
        with_thermal(winding_capacity=20.0, inverter_capacity=10.0), speed="held", initial_speed=5.0
    )
    heat = 0.0
    for _ in range(100):
        before = first.state[index("winding_rise")]
        first.advance(command((100.0 * GEAR, 100.0 * GEAR, 0.0, 0.0)), STRAIGHT)
        after = first.state[index("winding_rise")]
        heat += 20.0 * (after - before) + 0.5 * (before + after) / 0.015 * 0.01
    # The lag of the torque control, 5 ms, has taken 1.5 times itself from the square of the torque;
    # trapezoids: 1e-4.
    assert heat == pytest.approx(copper * (1.0 - 1.5 * 0.005), rel=1e-4)


@pytest.mark.parametrize("torque", [100.0, -100.0])
def test_heat_takes_torque_away_and_never_turns_it_around(torque):
    """Coolants up to the limit of 120 degC, above the warm 100.

    What is left of the peak torque falls linearly to 0.

    In 0.2 s the winding gets warmer by 0.03 K, less than two thousandths of the 20 K.
    """
    left, thermal = (
        [],
        {
            "winding_warm": 100.0,
            "winding_limit": 120.0,
            "inverter_warm": 190.0,
            "inverter_limit": 200.0,
        },
    )
    for coolant in (90.0, 100.0, 105.0, 110.0, 115.0, 119.0, 120.0):
        hot = with_thermal(coolant=coolant, **thermal)
        hot = dataclasses.replace(hot, motor=dataclasses.replace(hot.motor, peak_torque=100.0))
        out = drive(
            electrical(hot, speed="held", initial_speed=5.0),
            0.2,
            Wheels.front(2.0 * torque * GEAR, 2.0 * torque * GEAR),
        )
        left.append(out[MotorStates].effort.front_left / torque)
    assert left == pytest.approx([1.0, 1.0, 0.75, 0.5, 0.25, 0.05, 0.0], abs=2e-3)
    assert left == sorted(left, reverse=True)
    assert min(left) >= 0.0


def test_the_voltage_of_the_cells_limits_the_torque():
    """Full pedal beyond base speed gives the envelope at the battery's own, slow voltage."""
    torques = {}
    motor = dataclasses.replace(MOTOR, peak_power=1e6)
    for cells in (206, 103):
        car = dataclasses.replace(with_cells(in_series=cells, discharge_current=2e3), motor=motor)
        out = drive(
            electrical(car, speed="held", initial_speed=FAST), 0.5, Wheels.front(2000.0, 2000.0)
        )
        speed, voltage = out[MotorStates].velocity.front_left, out[BatteryCondition].voltage
        assert out[CellCondition].voltage == pytest.approx(voltage / cells, rel=1e-6)
        torques[cells] = out[MotorStates].effort.front_left
        envelope = voltage_limited_torque(MOTOR.winding, voltage, speed)
        assert torques[cells] == pytest.approx(min(envelope, 2000.0 / GEAR), rel=1e-3)
        assert out[MotorElectrics].current.front_left <= MOTOR.winding.largest_current * 1.001
        assert out[MotorElectrics].voltage.front_left <= voltage / 6.0**0.5
    assert torques[103] < 0.6 * torques[206]


def test_charge_is_counted():
    """State of charge lost = charge passed over capacity, in steps of 1 ms.

    Single precision leaves 1e-6.
    """
    car, passed = electrical(period=1e-3, initial_speed=20.0), 0.0
    for n in range(400):
        pedal = 900.0 if n < 200 else -500.0
        car.advance(command((pedal, pedal, 0.0, 0.0)), STRAIGHT)
        passed += outputs(car)[BatteryCondition].current * 1e-3
    gained = car.state[index("state_of_charge")] - 0.8
    assert gained == pytest.approx(passed / (BATTERY.capacity * 3600.0), rel=1e-5)


def test_cold_cells_are_not_charged_and_hot_ones_give_nothing():
    cold = electrical(with_cells(ambient=-5.0), initial_speed=20.0)
    out = drive(cold, 0.5, Wheels.front(-800.0, -800.0))
    assert out[BatteryCondition].current <= 1e-3
    hot = electrical(with_cells(ambient=60.0), initial_speed=20.0)
    assert drive(hot, 0.5, Wheels.front(800.0, 800.0))[
        MotorStates
    ].effort.front_left == pytest.approx(0.0, abs=1e-9)
    warm = electrical(with_cells(ambient=52.5), initial_speed=20.0)
    out = drive(warm, 0.5, Wheels.front(2000.0, 2000.0))
    assert 0.0 < -out[BatteryCondition].current <= 0.5 * 490.0 * (1.0 + 1e-6)
    assert out[CellCondition].temperature > 52.5


def test_brushless_drives_have_no_electrical_side():
    with pytest.raises(
        ParameterError, match="electrical needs drive torque_controlled, not switched"
    ):
        electrical(drive="switched")
