"""Electrical and thermal signals of the motors and of one cell; what holds for `signals` holds here."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ev_msgs_py.contract.field import Field, magnitude
from ev_msgs_py.contract.wheels import Wheels


class MotorElectrics(NamedTuple):
    """Phase current and voltage of the motor of each wheel, rms, and its power; zero where there is none.

    Through and across, as in bond graphs: what drives is the effort, what flows the velocity.
    """

    current: Annotated[
        Wheels, Field("A", "of a phase, rms", "{wheel}_phase.velocity", sensor="motor_current", largest=1e3)
    ]
    voltage: Annotated[
        Wheels, Field("V", "phase to neutral, rms", "{wheel}_phase.effort", sensor="motor_voltage", largest=1e3)
    ]
    power: Annotated[
        Wheels, Field("W", "from the DC link", "{wheel}_dc_link.effort", sensor="motor_power", largest=1e6)
    ]


class MotorTemperatures(NamedTuple):
    """Temperatures of motor, inverter and coolant of each wheel, as efforts; zero where there is no motor."""

    winding: Annotated[
        Wheels, Field("degC", "of the winding", "{wheel}_winding.effort", sensor="winding_temperature", largest=100.0)
    ]
    inverter: Annotated[
        Wheels,
        Field("degC", "of the power stage", "{wheel}_inverter.effort", sensor="inverter_temperature", largest=100.0),
    ]
    coolant_inlet: Annotated[
        Wheels, Field("degC", "into both", "{wheel}_coolant_inlet.effort", sensor="coolant_temperature", largest=100.0)
    ]
    coolant_outlet: Annotated[
        Wheels,
        Field("degC", "out of both", "{wheel}_coolant_outlet.effort", sensor="coolant_temperature", largest=100.0),
    ]
    coolant_flow: Annotated[
        Wheels,
        Field("l/min", "through both", "{wheel}_coolant_inlet.velocity", sensor="coolant_flow", largest=100.0),
    ]


class CellCondition(NamedTuple):
    """One cell of the traction battery, in the single precision that BatteryState carries."""

    voltage: Annotated[
        float, magnitude("V", "at its terminals", "voltage", single_precision=True, sensor="cell_voltage", largest=1.0)
    ]
    temperature: Annotated[
        float,
        Field("degC", "of the cells", "temperature", single_precision=True, sensor="cell_temperature", largest=100.0),
    ]
