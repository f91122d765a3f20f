"""One circuit on its channel: frames in, one cycle, frames out. No bus, no clock: time is counted from outside."""

from __future__ import annotations

from math import sqrt
from typing import Any

from ev_msgs_py.can.channel import Frame
from ev_msgs_py.can.conventions import RPM
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.drive_states import OPERATION_ENABLED, QUICK_STOP_ACTIVE
from ev_msgs_py.can.faults import FAULTS, WARNINGS
from ev_msgs_py.can.protection import last_counter, next_counter
from ev_msgs_py.can.schedule import TICK, is_due
from ev_msgs_py.lockstep.law import namespace
from ev_msgs_py.parameters.declaration import number_tree
from ev_sim.inverter.circuit import advance_circuit
from ev_sim.inverter.inverter import statusword
from ev_sim.inverter.parameters import CircuitParameters
from ev_sim.inverter.set_points import grow_older, receive_set_point, set_point_layout
from ev_sim.inverter.state import Circuit, Inverter
from ev_sim.inverter.temperatures import coolant_outlet, inverter_temperature, winding_temperature

SENT = ("Motion", "Electrical", "Temperatures", "Faults")
_MADE_GOOD = 5  # cycles that are made up for at once
_WRONG = 0xFF  # what a corrupted checksum is changed by


class InverterStation:
    """One inverter: takes its set-points and says what its frames say."""

    p: Any  # the numbers of its parameters

    def __init__(self, database: Database, device: str, s: Inverter) -> None:
        self.device, self.s = device, s
        set_point = database[f"{device}_SetPoint"]
        self._identifier, self._length, self._layout = (
            set_point.identifier,
            set_point.length,
            set_point_layout(set_point),
        )
        self._frames = [database[f"{device}_{kind}"] for kind in SENT]

    def receive(self, frame: Frame) -> None:
        """Take a frame if it is a set-point of this inverter; one with another length counts as damaged."""
        if frame.identifier != self._identifier:
            return
        data = frame.data if len(frame.data) == self._length else bytes([_WRONG])
        receive_set_point(self._layout, self.s, int.from_bytes(data, "little"))

    def due(self, before: int, now: int, speed: float) -> list[Frame]:
        """The frames whose cycle ends between two ticks."""
        if self.s.injected.silent != 0.0:
            return []
        return [
            self._made(place, speed) for place, layout in enumerate(self._frames) if is_due(layout.cycle, before, now)
        ]

    def _made(self, place: int, speed: float) -> Frame:
        layout, s = self._frames[place], self.s
        values = (self._motion, self._electrical, self._temperatures, self._faults)[place](speed)
        frozen = s.injected.frozen_counter != 0.0
        counter = int(s.counters[place])
        data = layout.pack(values, last_counter(counter) if frozen else counter)
        if not frozen:
            s.counters[place] = float(next_counter(counter))
        if s.injected.wrong_crc != 0.0:
            data = bytes([data[0] ^ _WRONG]) + data[1:]
        return Frame(layout.identifier, data)

    def _motion(self, speed: float) -> dict[str, float]:
        return {
            "CommandCheck": self.s.check.status,
            "Torque": self.s.torque,
            "Speed": speed / RPM,
            "Statusword": float(statusword(self.s)),
        }

    def _electrical(self, speed: float) -> dict[str, float]:
        return {
            "DcVoltage": self.s.dc_link.voltage + self.s.injected.voltage_rise,
            "DcCurrent": self.s.dc_current,
            "PhaseCurrent": self.s.phase_current + self.s.injected.current_rise,
            "PhaseVoltage": self._phase_voltage(speed),
        }

    def _phase_voltage(self, speed: float) -> float:
        """Of the rotor, as P = sqrt(3) U I = T w; field weakening keeps it within what a power stage can give."""
        induced = self.p.torque_constant * abs(speed) / sqrt(3.0)
        switches = int(self.s.state) in (OPERATION_ENABLED, QUICK_STOP_ACTIVE)
        return min(induced, self.s.dc_link.voltage / sqrt(2.0)) if switches else induced

    def _temperatures(self, speed: float) -> dict[str, float]:
        thermal = self.p.thermal
        winding = winding_temperature(thermal, self.s)
        return {
            "Winding": winding,
            "Inverter": inverter_temperature(thermal, self.s),
            "CoolantIn": thermal.coolant,
            "CoolantOut": coolant_outlet(thermal, self.s),
            "Rotor": winding,  # not modelled by itself
            "CoolantFlow": thermal.coolant_flow,
        }

    def _faults(self, speed: float) -> dict[str, float]:
        faults, warnings = int(self.s.faults), int(self.s.warnings)
        return {
            "ErrorCode": self.s.error_code,
            **{fault.name: float(faults >> place & 1) for place, fault in enumerate(FAULTS)},
            **{name: float(warnings >> place & 1) for place, name in enumerate(WARNINGS)},
        }


class CircuitStation:
    """The two inverters of a circuit on one channel, with their shaft."""

    def __init__(self, database: Database, circuit: str, parameters: CircuitParameters) -> None:
        self.s = Circuit()
        self.inverters = (
            InverterStation(database, f"Drive{circuit}", self.s.drive),
            InverterStation(database, f"Load{circuit}", self.s.load),
        )
        self.change(parameters)

    def change(self, parameters: CircuitParameters) -> None:
        """Go on with other parameters."""
        self.p = namespace(number_tree(parameters))
        self.inverters[0].p, self.inverters[1].p = self.p.drive, self.p.load

    def receive(self, frame: Frame) -> None:
        """Take a frame of the channel."""
        for inverter in self.inverters:
            inverter.receive(frame)

    def step(self, ticks: int = 1) -> list[Frame]:
        """Advance by some cycles of 1 ms, after the frames of this cycle; what is to be sent then.

        After more than a few the machines stand still for the rest, as a burst of late cycles would be no real time;
        the set-points get older all the same.
        """
        before, lost = int(self.s.tick), max(ticks - _MADE_GOOD, 0)
        for inverter in self.inverters:
            grow_older(inverter.s, lost * TICK)
        for _ in range(ticks - lost):
            advance_circuit(self.p, self.s, TICK)
        self.s.tick += ticks
        return [f for inverter in self.inverters for f in inverter.due(before, before + ticks, self.s.speed)]
