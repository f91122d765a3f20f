"""Signals of actuators that only some cars have."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ev_msgs_py.contract.field import Field, leftward


class RearSteeringState(NamedTuple):
    """The steered rear wheels, the motor that turns them, and what it takes."""

    angle: Annotated[
        float,
        leftward("rad", "of both rear wheels", "rear_wheels.position", sensor="rear_wheel_angle", largest=1.0),
    ]
    rate: Annotated[
        float,
        leftward("rad/s", "of both rear wheels", "rear_wheels.velocity", sensor="rear_wheel_rate", largest=10.0),
    ]
    motor_speed: Annotated[
        float,
        leftward(
            "rad/s", "of the shaft of the steering motor", "steering_motor.velocity",
            sensor="steering_motor_speed", largest=1e3,
        ),
    ]  # fmt: skip
    motor_torque: Annotated[
        float,
        leftward(
            "N m", "at the shaft of the steering motor", "steering_motor.effort",
            sensor="steering_motor_torque", largest=100.0,
        ),
    ]  # fmt: skip
    power: Annotated[
        float,
        Field("W", "from the supply, mean over the last period", "supply.effort", sensor="supply_power", largest=1e5),
    ]
