"""The planar plant on the test bench, as parameters."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import parameter
from ev_sim.plant.planar.parameters import PlanarParameters

WHEEL_SPEEDS = ("virtual", "load_machine")
VIRTUAL, LOAD_MACHINE = range(len(WHEEL_SPEEDS))


@dataclass(frozen=True, slots=True)
class PlanarOnBenchParameters(PlanarParameters):
    """The planar plant, and how it takes what the bench measures."""

    rotor_share: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the rotor's torque J w' that is added to the measured one: the virtual car's wheel has the "
        "rotor's inertia, but the torque behind the rotor, where the transducer sits, has moved the rotor already",
        source="assumption: the source drives the wheel with the measured torque and does not speak of the rotor",
    )
    wheel_speed: str = parameter(
        "load_machine",
        choices=WHEEL_SPEEDS,
        about="with which speed a driven wheel meets the road: load_machine: the one measured at its load machine; "
        "virtual: the one that the load machine is told to hold, the default behind a real bus",
        source="dissertation, section 4.1: the speed of the load machine is that of the virtual driven wheel",
    )
