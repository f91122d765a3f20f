"""The machines of the bench; names as in the vehicle description, whose limits and losses are computed with them."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.winding import Winding

_TABLE = "dissertation, table 1.1"
_ASSUMED = "assumption, as in the vehicle dissertation_class_b"


@dataclass(frozen=True, slots=True)
class Machine:
    """The machine under test, a YASA-400."""

    peak_torque: float = parameter(360.0, unit="N m", low=0.0, high=1000.0, about="at the shaft", source=_TABLE)
    nominal_torque: float = parameter(
        250.0, unit="N m", low=1e-3, high=1000.0, about="at the shaft; temperatures decide for how long", source=_TABLE
    )
    peak_power: float = parameter(150e3, unit="W", low=1.0, high=1e7, about="mechanical", source=_TABLE)
    maximum_speed: float = parameter(
        785.398, unit="rad/s", low=1.0, high=1047.2, about="of the shaft; no drive torque beyond", source=_TABLE
    )
    generator_torque: float = parameter(
        360.0, unit="N m", low=0.0, high=1000.0, about="largest torque against the speed", source="assumption"
    )
    generator_power: float = parameter(
        150e3, unit="W", low=0.0, high=1e7, about="largest power from the shaft", source="assumption"
    )
    torque_lag: float = parameter(
        0.002, unit="s", low=1e-4, high=10.0, about="time constant of the torque control", source="assumption"
    )
    rotor_inertia: float = parameter(
        0.02, unit="kg m^2", low=1e-4, high=100.0, about="of the rotor", source="assumption"
    )
    copper_loss: float = parameter(
        0.045, unit="W/(N m)^2", low=0.0, high=1e3, about="loss per squared torque", source=_ASSUMED
    )
    iron_loss: float = parameter(1.0, unit="W s/rad", low=0.0, high=1e3, about="loss per speed", source=_ASSUMED)
    eddy_loss: float = parameter(
        1e-3, unit="W s^2/rad^2", low=0.0, high=10.0, about="loss per squared speed", source=_ASSUMED
    )
    inverter_loss: float = parameter(60.0, unit="W", low=0.0, high=1e4, about="loss without torque", source=_ASSUMED)
    inverter_torque_loss: float = parameter(
        2.0, unit="W/(N m)", low=0.0, high=100.0, about="loss per torque", source=_ASSUMED
    )
    winding: Winding = group(Winding)


_LOST = "data of the 1PV5138-4WS24 are lost in the source: assumed to hold the machine under test up to 10000 rpm"


@dataclass(frozen=True, slots=True)
class LoadMachine(Machine):
    """The load machine, an asynchronous one; its limits by voltage are taken for those of a synchronous one."""

    peak_torque: float = parameter(400.0, unit="N m", low=0.0, high=1000.0, about="at the shaft", source=_LOST)
    maximum_speed: float = parameter(
        1047.0, unit="rad/s", low=1.0, high=1047.2, about="of the shaft; no drive torque beyond", source=_LOST
    )
    generator_torque: float = parameter(
        400.0, unit="N m", low=0.0, high=1000.0, about="largest torque against the speed", source=_LOST
    )
    torque_lag: float = parameter(
        0.001, unit="s", low=1e-4, high=10.0, about="time constant of the torque control", source=_LOST
    )
    rotor_inertia: float = parameter(0.1, unit="kg m^2", low=1e-4, high=100.0, about="of the rotor", source=_LOST)
    winding: Winding = group(Winding, inductance=5e-5, largest_current=505.0)
