"""A pedal that stands for a power."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.urban_runs import CAR as VEHICLE

from ev_core.lockstep.configuration import configure
from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.driver.urban_drivers import PowerLevelParameters, torque_of_power

CAR = namespace(car_numbers(VEHICLE))
LEVEL = PowerLevelParameters()


def test_power_by_hand():
    """K (phi + f) W V/(1 - s).

    Half the power at half the speed, less torque where the wheels spin.
    """
    load = 2170 * 9.81 * CAR.centre_of_mass_to_rear_axle / CAR.wheelbase
    spinning = WheelStates(NO_WHEELS, Wheels.front(40.0, 60.0), NO_WHEELS)
    power = LEVEL.factor * (0.4022 + 0.083) * load * 8.0 / (1 - 0.0907)
    assert torque_of_power(LEVEL, CAR, 8.0, spinning) == pytest.approx(power / 50.0, rel=1e-12)
    assert torque_of_power(LEVEL, CAR, 4.0, spinning) == pytest.approx(power / 100.0, rel=1e-12)
    at_rest = WheelStates(NO_WHEELS, NO_WHEELS, NO_WHEELS)
    assert torque_of_power(LEVEL, CAR, 0.0, at_rest) == pytest.approx(power / 8.0 * 0.32, rel=1e-12)


def test_driven_wheels_carry_the_power():
    """The load with all wheels driven is the whole weight, and the mean speed that of all four."""
    all_wheels = namespace(car_numbers(dataclasses.replace(VEHICLE, driven_wheels=WHEEL_NAMES)))
    rolling = WheelStates(NO_WHEELS, Wheels(20.0, 30.0, 40.0, 50.0), NO_WHEELS)
    power = LEVEL.factor * (0.4022 + 0.083) * 2170 * 9.81 * 8.0 / (1 - 0.0907)
    assert torque_of_power(LEVEL, all_wheels, 8.0, rolling) == pytest.approx(
        power / 35.0, rel=1e-12
    )


@pytest.mark.parametrize("method", ["pulse", "imposed_speed"])
def test_power_needs_a_driven_wheel(method):
    with pytest.raises(
        ParameterError, match=f"driver method {method} needs at least one driven wheel"
    ):
        configure("driver", {"method": method, "vehicle.driven_wheels": []})
