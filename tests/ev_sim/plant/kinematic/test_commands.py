"""Commands that no car can follow are counted and not taken."""

import math

import pytest
from plant.kinematic.car import COAST, Car

from ev_core.parameters.record import names
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_sim.plant.kinematic import KinematicPlantState


def brake_of(**wheels):
    return WheelTorqueCommand(NO_WHEELS, NO_WHEELS._replace(**wheels))


def moved(command):
    """The outputs of a rolling car a period later, and what it counted."""
    plant = Car(initial_speed=5.0).drive(command).plant
    kept = dict(zip(names(KinematicPlantState()), plant.state, strict=True))
    return plant.outputs(), (kept["guard.non_finite"], kept["guard.out_of_range"])


@pytest.mark.parametrize(
    ("command", "accepted", "counts"),
    [
        (
            WheelTorqueCommand(Wheels(10.0, 10.0, 5.0, 0.0)),
            WheelTorqueCommand(Wheels.front(10.0, 10.0)),
            (0, 1),
        ),
        (
            WheelTorqueCommand(NO_WHEELS, Wheels(0.0, -1.0, 0.0, 9e9)),
            brake_of(rear_right=4000.0),
            (0, 2),
        ),
        (
            WheelTorqueCommand(Wheels.front(math.nan, -math.inf), Wheels.all(math.nan)),
            COAST,
            (6, 0),
        ),
    ],
)
def test_impossible_commands_are_counted_and_not_taken(command, accepted, counts):
    """Wheels without a motor get none, infinite ones 0, all else the nearest limit."""
    assert moved(command) == (moved(accepted)[0], counts)


def test_an_angle_that_is_not_finite_keeps_the_last_one():
    car = Car(initial_speed=5.0).drive(degrees=10.0)
    again = Car(initial_speed=5.0).drive(degrees=10.0, steps=12)
    assert car.plant.reports() == ()
    car.drive(degrees=math.nan, steps=11)
    assert car.plant.outputs() == again.plant.outputs()
    assert car.plant.reports() == ("10 or more values of commands were not finite",)
