"""A drive on a test bench, compiled.

Torque reference and shaft speed in, what it does over time out.
"""

from types import SimpleNamespace

import numpy as np

from ev_core.compiled.loop import compiled, one_record
from ev_core.parameters.declaration import number_tree
from ev_core.parameters.values import build
from ev_sim.drives import drive
from ev_sim.drives.brushless_motor import DriveState
from ev_sim.drives.drive import DriveParameters

BUS_VOLTAGE = 480.0
TORQUE_CONSTANT = 2 * 10 * 0.2  # 2 p psi [N m/A]
INDUCTANCE = 0.008
RESISTANCE = 0.15
CONTROLS = (
    {"drive": "averaged"},
    {"drive": "switched"},
    {"drive": "switched", "switched.current_control": "pwm"},
)
SWITCHED = CONTROLS[1:]

advance_drive = compiled(drive.advance_drive)


def name_of(changes):
    return " ".join(changes.values())


def drive_with(changes):
    """A drive at rest and its parameters; those of the motor are those of a phase."""
    built = build(DriveParameters, {"motor.winding": "phase", **changes})
    return one_record(DriveState())[0], one_record(number_tree(built))[0]


def run(changes, torque, speed, *, duration, step=1e-3, bus_voltage=BUS_VOLTAGE, settled=0.0):
    """Advance a drive from rest at a constant speed.

    Its samples after the time `settled`, and the drive.
    """
    state, parameters = drive_with(changes)
    samples = {name: [] for name in state.dtype.names}
    for k in range(round(duration / step)):
        advance_drive(state, parameters, torque, speed, bus_voltage, step)
        if k >= round(settled / step):
            for name, values in samples.items():
                values.append(state[name].item())
    return SimpleNamespace(
        **{name: np.array(values) for name, values in samples.items()}, state=state
    )


def magnetic_energy(drive, state):
    high, off = state["high_current"], state["off_current"]
    if drive == "averaged":
        return INDUCTANCE * state["current"] ** 2  # L i^2/2 in each of two phases
    return INDUCTANCE / 2 * (high**2 + off**2 + (high + off) ** 2)
