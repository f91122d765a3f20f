"""Messages of packages that are not on PyPI, with the fields that are used here.

Names, defaults and constants are those of simulation_interfaces 2.1.0, autoware_msgs and
ackermann_msgs as of 2026.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

_GEARS = "NONE=0 NEUTRAL=1 DRIVE=2 DRIVE_18=19 REVERSE=20 REVERSE_2=21 PARK=22 LOW=23 LOW_2=24"
_RESULT = {"result": 0, "error_message": ""}


class StandIn(SimpleNamespace):
    """A message: its fields are given, else zero.

    Another field than those of its definition is refused.
    """

    constants: dict[str, int]
    fields: dict[str, Any]

    def __init__(self, **given: Any) -> None:
        unknown = given.keys() - self.fields.keys()
        assert not unknown, unknown
        made = {name: value() if callable(value) else value for name, value in self.fields.items()}
        super().__init__(**{**made, **given})


def kind(constants: str = "", **fields: Any) -> type:
    """A class of messages."""
    named = {name: int(value) for name, value in (each.split("=") for each in constants.split())}
    return type("StandIn", (StandIn,), {"fields": fields, **named})


Time = kind(sec=0, nanosec=0)
Header = kind(stamp=Time, frame_id="")
Result = kind(
    "RESULT_FEATURE_UNSUPPORTED=0 RESULT_OK=1 RESULT_NOT_FOUND=2 RESULT_INCORRECT_STATE=3 RESULT_OPERATION_FAILED=4",
    **_RESULT,
)
State = kind(
    "STATE_STOPPED=0 STATE_PLAYING=1 STATE_PAUSED=2 STATE_QUITTING=3 STATE_NO_WORLD=4", state=0
)
Features = kind(
    "SPAWNING=0 SIMULATION_RESET=20 SIMULATION_RESET_TIME=21 SIMULATION_RESET_STATE=22 SIMULATION_STATE_GETTING=24 "
    "SIMULATION_STATE_SETTING=25 SIMULATION_STATE_PAUSE=26 STEP_SIMULATION_SINGLE=31 STEP_SIMULATION_MULTIPLE=32 "
    "STEP_SIMULATION_ACTION=33",
    features=list,
    spawn_formats=list,
    custom_info="",
)


def service(request: type, response: type) -> Any:
    """A service with these two."""
    return SimpleNamespace(Request=request, Response=response)


KINDS: dict[str, Any] = {
    "simulation_interfaces/msg/Result": Result,
    "simulation_interfaces/msg/SimulationState": State,
    "simulation_interfaces/msg/SimulatorFeatures": Features,
    "simulation_interfaces/srv/GetSimulatorFeatures": service(kind(), kind(features=Features)),
    "simulation_interfaces/srv/GetSimulationState": service(
        kind(), kind(state=State, result=Result)
    ),
    "simulation_interfaces/srv/SetSimulationState": service(
        kind(state=State),
        kind(
            "ALREADY_IN_TARGET_STATE=101 STATE_TRANSITION_ERROR=102 INCORRECT_TRANSITION=103",
            result=Result,
        ),
    ),
    "simulation_interfaces/srv/StepSimulation": service(kind(steps=1), kind(result=Result)),
    "simulation_interfaces/srv/ResetSimulation": service(
        kind("SCOPE_DEFAULT=0 SCOPE_TIME=1 SCOPE_STATE=2 SCOPE_SPAWNED=4 SCOPE_ALL=255", scope=0),
        kind(result=Result),
    ),
    "simulation_interfaces/action/SimulateSteps": SimpleNamespace(
        Goal=kind(steps=0),
        Result=kind(result=Result),
        Feedback=kind(completed_steps=0, remaining_steps=0),
    ),
    "autoware_control_msgs/msg/Control": kind(
        stamp=Time,
        control_time=Time,
        lateral=kind(
            stamp=Time,
            control_time=Time,
            steering_tire_angle=0.0,
            steering_tire_rotation_rate=0.0,
            is_defined_steering_tire_rotation_rate=False,
        ),
        longitudinal=kind(
            stamp=Time,
            control_time=Time,
            velocity=0.0,
            acceleration=0.0,
            jerk=0.0,
            is_defined_acceleration=False,
            is_defined_jerk=False,
        ),
    ),
    "autoware_vehicle_msgs/msg/GearCommand": kind(_GEARS, stamp=Time, command=0),
    "autoware_vehicle_msgs/msg/GearReport": kind(_GEARS, stamp=Time, report=0),
    "autoware_vehicle_msgs/msg/VelocityReport": kind(
        header=Header, longitudinal_velocity=0.0, lateral_velocity=0.0, heading_rate=0.0
    ),
    "autoware_vehicle_msgs/msg/SteeringReport": kind(stamp=Time, steering_tire_angle=0.0),
    "autoware_vehicle_msgs/msg/ControlModeReport": kind(
        "NO_COMMAND=0 AUTONOMOUS=1 MANUAL=4 DISENGAGED=5 NOT_READY=6", stamp=Time, mode=0
    ),
    "ackermann_msgs/msg/AckermannDriveStamped": kind(
        header=Header,
        drive=kind(
            steering_angle=0.0, steering_angle_velocity=0.0, speed=0.0, acceleration=0.0, jerk=0.0
        ),
    ),
}
