"""All that the author of a law needs, by one import.

`from ev_core.law import method, parameter, compilable, ...`.

- to declare a method: `method`, `SAME`; its parameters: `parameter`, `setting`, `group`,
  `ParameterError`; a `Choice`
- state, records of numbers: `entry`, `per_wheel`, `series`, `part`, `each_wheel`, and `row` of
  `Place` and `wheel_places`; within a step: `working_memory` of a `memory_type`
- marks of what may run compiled: `compilable`, `inlined`
- the vehicle: `Car` for the numbers that a law reads, `Vehicle` for the description, `GRAVITY`,
  `speed_along_path`, `turning_length`
- what the vehicle must have (`needs=`): `any_driven`, `each_driven`, `equal_motors`, `driven`,
  `only_driven`, `FRONT_WHEELS_DRIVEN`, `REAR_WHEELS_DRIVEN`, `ALL_WHEELS_DRIVEN`, and `Need` for
  one of your own
- one value per wheel: `Wheels`, `NO_WHEELS`, `WHEEL_NAMES` and the places `FRONT_LEFT` to
  `REAR_RIGHT`
- signals, from `DriverCommand` to `BenchEnergy` (docs/topics.md), and `Instant`, the time of a step
- elementary functions, from `sin` to `hypot` (docs/elementary_functions.md)

What traction controls and differentials share, such as `traction_control` and `split`, is in
`ev_control.law`. Nothing in ev_core imports this module: it is a door from outside.
"""

from ev_core.elementary import *  # as its __all__ lists them
from ev_core.methods.hooks import SAME
from ev_core.methods.register import method
from ev_core.parameters.declaration import Choice, group, parameter, setting
from ev_core.parameters.record import (
    Place,
    each_wheel,
    entry,
    memory_type,
    part,
    per_wheel,
    row,
    series,
    wheel_places,
    working_memory,
)
from ev_core.vehicle.car import (
    ALL_WHEELS_DRIVEN,
    FRONT_WHEELS_DRIVEN,
    GRAVITY,
    REAR_WHEELS_DRIVEN,
    Car,
    Need,
    any_driven,
    driven,
    each_driven,
    equal_motors,
    only_driven,
    speed_along_path,
    turning_length,
)
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.compilable import compilable, inlined
from ev_msgs_py.contract.optional_signals import (
    BatteryCoolant,
    BenchCoolant,
    BenchElectrical,
    BenchEnergy,
    BenchShafts,
    BenchTemperatures,
    BodyRoll,
    CellCondition,
    LoadCommand,
    MotorElectrics,
    MotorTemperatures,
    RearSteeringState,
    WheelSpeedCommand,
)
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    Instant,
    MotorStates,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.wheels import (
    FRONT_LEFT,
    FRONT_RIGHT,
    NO_WHEELS,
    REAR_LEFT,
    REAR_RIGHT,
    WHEEL_NAMES,
    Wheels,
)
from ev_msgs_py.refusal import ParameterError

__all__ = [name for name in globals() if not name.startswith("_")]
