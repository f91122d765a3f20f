"""A machine under test and a load machine on one shaft."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_sim.inverter.inverter import advance_inverter
from ev_sim.inverter.parameters import CircuitParameters
from ev_sim.inverter.state import Circuit


@compilable
def advance_circuit(p: CircuitParameters, s: Circuit, period: float) -> None:
    """Advance both inverters, then the shaft, which is rigid: (J_drive + J_load) w' = T_drive + T_load - b w."""
    advance_inverter(p.drive, s.drive, s.speed, period)
    advance_inverter(p.load, s.load, s.speed, period)
    inertia = p.drive.machine.rotor_inertia + p.load.machine.rotor_inertia
    s.speed = (s.speed + period * (s.drive.torque + s.load.torque) / inertia) / (1.0 + period * p.friction / inertia)
