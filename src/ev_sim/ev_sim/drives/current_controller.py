"""PI control of the current through two phases in series, with anti-windup and EMF feedforward."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import parameter
from ev_sim.drives.motor import MotorParameters, torque_constant
from ev_sim.drives.state import DriveState


@dataclass(frozen=True, slots=True)
class CurrentControllerParameters:
    """Current controller; Shchur (2019) gives none, so its structure and its parameters are assumptions."""

    bandwidth: float = parameter(
        3000.0,
        unit="rad/s",
        low=1.0,
        high=1e5,
        about="bandwidth of the closed current loop; the zero of the controller cancels the pole -R/L of the motor",
    )
    emf_feedforward: float = parameter(
        1.0, unit="1", low=0.0, high=1.0, about="share of the EMF that the controller adds from the measured speed"
    )


@compilable
def controlled_voltage(
    s: DriveState,
    controller: CurrentControllerParameters,
    motor: MotorParameters,
    current_reference: float,
    current: float,
    speed: float,
    bus_voltage: float,
    sampling_period: float,
) -> float:
    """Voltage across the two phases for the next sampling period, within -bus_voltage..bus_voltage [V].

    Advances `s.voltage_integral`. Where the bus limits the voltage, the integral takes only as much of the error
    as the motor has seen (back-calculation). Currents in A, shaft speed in rad/s.
    """
    proportional_gain = controller.bandwidth * 2.0 * motor.inductance
    integral_gain = controller.bandwidth * 2.0 * motor.resistance
    error = current_reference - current
    emf = torque_constant(motor) * speed
    wanted = proportional_gain * error + s.voltage_integral + controller.emf_feedforward * emf
    voltage = min(max(wanted, -bus_voltage), bus_voltage)
    s.voltage_integral += sampling_period * integral_gain * (error + (voltage - wanted) / proportional_gain)
    return voltage
