"""What the study of faults drives: a left turn in which the car speeds up, and what goes wrong in mid-turn."""

from __future__ import annotations

from typing import Any

BEGIN = 5.0  # of the fault [s]
DURATION = 10.0  # [s]
SCENARIO = "double_lane_change"
ROADS = {"dry": "dry_asphalt", "wet": "wet_asphalt_1"}
BY_WIRE = ("drive_by_wire", "steer_by_wire")
POWERED = " (powered)"  # behind the name of a law: on the column of Shchur (2019), whose lever is half the track
SOUND = "none"

# 40 m straight on, then a circle of 100 m radius at 60 km/h; from 4 s on the driver goes up to 75 km/h within 5 s. The
# gains of the hands are softer than those of other path followers, with which the assistance of the steering swings.
TURN: tuple[tuple[str, str, Any], ...] = (
    ("plant", "initial_x", 0.0),
    ("plant", "initial_speed", 60 / 3.6),
    ("driver", "speed_profile.time", [0.0, 4.0, 9.0]),
    ("driver", "speed_profile.speed", [60 / 3.6, 60 / 3.6, 75 / 3.6]),
    ("driver", "path.shape", "arcs"),
    ("driver", "path.length", [40.0, 600.0]),
    ("driver", "path.curvature", [0.0, 0.01]),
    ("driver", "hands.angle_control.proportional_gain", 0.5),
    ("driver", "hands.angle_control.integral_gain", 1.0),
    ("driver", "hands.angle_control.derivative_gain", 0.1),
)

_COLUMN = "steering_column/state"
_LAW = "torque_request"
FAULTS: dict[str, dict[str, list[str]]] = {  # what is wrong -> by role
    SOUND: {},
    "inner motor dead": {"plant": ["motor_share front_left 0"]},
    "outer motor dead": {"plant": ["motor_share front_right 0"]},
    "inner motor at half": {"plant": ["motor_share front_left 0.5"]},
    "outer motor stuck": {"plant": ["motor_stuck front_right"]},
    "inverters 0.1 s late": {"plant": ["inverter_delay front 0.1"]},
    "battery cut off": {"plant": ["battery_share battery 0"]},
    "outer front tyre flat": {"plant": ["puncture front_right 1"]},
    "outer rear tyre flat": {"plant": ["puncture rear_right 1"]},
    "inner wheel speed reads 0": {"plant": ["constant wheel_states.velocity.front_left 0"]},
    "front wheel speeds swapped": {
        "plant": ["swapped wheel_states.velocity.front_left,wheel_states.velocity.front_right"]
    },
    "accelerometer tilted by 0.1": {"plant": ["tilted imu.longitudinal_acceleration 0.1"]},
    "steering angle 0.2 rad off": {"steering_column": [f"offset {_COLUMN}.angle 0.2"]},
    "hand torque sensor lost": {"steering_column": [f"constant {_COLUMN}.hand_torque 0"]},
    "every third message lost": {"steering_column": [f"lost {_COLUMN} 0.333"], "plant": ["lost wheel_states 0.333"]},
    "law restarted for 0.5 s": {"electronic_differential": [f"restarted {_LAW}"]},
}
OF_MOTORS = ("inner motor dead", "outer motor dead", "inner motor at half", "outer motor stuck")
_ENDS = {"law restarted for 0.5 s": BEGIN + 0.5}


def values_of(road: str, law: str, asr: str, fault: str) -> tuple[tuple[str, str, Any], ...]:
    """What differs from the scenario's own file in one case."""
    name = law.removesuffix(POWERED)
    column = "by_wire" if law in BY_WIRE else "manual" if law == name else "powered"
    until = f" until {_ENDS[fault]:g}" if fault in _ENDS else ""
    return (
        *TURN,
        ("plant", "road.left", [ROADS[road]]),
        ("plant", "road.right", [ROADS[road]]),
        ("electronic_differential", "method", name),
        ("asr", "method", asr),
        ("steering_column", "method", column),
        *((("asr", "plausibility.keep_difference", column != "manual"),) if asr == "limp_home" else ()),
        *(
            (role, "faults", [f"{text} from {BEGIN:g}{until}" for text in texts])
            for role, texts in FAULTS[fault].items()
        ),
    )
