"""The devices of the test bench behind a CAN bus, as parameters."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.can.bus_model import BusModelParameters
from ev_msgs_py.parameters.declaration import group, parameter
from ev_sim.inverter.parameters import DcLinkParameters
from ev_sim.test_bench.bus_faults import BusFaultParameters
from ev_sim.test_bench.parameters import CircuitsParameters


@dataclass(frozen=True, slots=True)
class CanCircuitsParameters(CircuitsParameters):
    """The same devices; set-points and feedback of the machines under test go over a bus."""

    bus: BusModelParameters = group(BusModelParameters)
    command_timeout: float = parameter(
        0.01, unit="s", low=0.001, high=1.0, about="without a valid set-point for longer than this: fault"
    )
    dc_link: DcLinkParameters = group(DcLinkParameters)
    inject: BusFaultParameters = group(BusFaultParameters)
