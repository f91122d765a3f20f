"""All that lasts is in the state: a run goes on from it in another plant, to the bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from plant.planar.car import CAR, FOUR_MOTORS, by_each_way, command, plant, steered

from ev_core.parameters.record import names
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import Driveline
from ev_sim.plant.planar.planar_state import INTEGRATED_PLACES, PlanarState, index

IMPOSED_SPEED = {
    "imposed_speed__time": (0.0, 1.0),
    "imposed_speed__speed": (5.0, 9.0),
    "initial_speed": 5.0,
}
RANDOM = {
    "road__pattern": "random",
    "road__random_shortest": 0.5,
    "road__random_longest": 2.0,
    "initial_speed": 15.0,
}
CLUTCHES = dataclasses.replace(FOUR_MOTORS, driveline=Driveline(coupling="clutch"))
TALL = dataclasses.replace(CAR, centre_of_mass_height=1.2)
CASES: dict[str, tuple[Vehicle, dict]] = {
    "imposed speed": (CAR, {"speed": "imposed", **IMPOSED_SPEED}),
    "averaged drives": (CAR, {"drive": "averaged", "initial_speed": 5.0}),
    "switched drives": (CAR, {"drive": "switched", "initial_speed": 3.0}),
    "clutches on a random road": (CLUTCHES, RANDOM),
    "wheels that lift": (TALL, {"initial_speed": 25.0}),
}


def inputs(seed: int):
    """Random commands, a few of which no plant takes as they come."""
    generator = np.random.default_rng(seed)
    while True:
        drive, brake = generator.uniform(-500, 900, 4), generator.uniform(-100, 400, 4)
        if generator.random() < 0.1:
            drive[0] = brake[1] = np.nan
        yield command(drive, brake), steered(*generator.uniform(-0.3, 0.3, 2))


@by_each_way
@pytest.mark.parametrize("name", CASES)
def test_a_run_goes_on_from_its_state(name, way):
    car, parameters = CASES[name]
    first, second = (plant(car, **parameters, **way) for _ in range(2))
    given = inputs(1)
    for _ in range(40):
        first.advance(*next(given))
    second.state = first.state
    assert second.outputs() == first.outputs()
    for _ in range(40):
        signals = next(given)
        first.advance(*signals)
        second.advance(*signals)
        assert second.state.tobytes() == first.state.tobytes()
        assert second.outputs() == first.outputs()
    assert second.reports() == first.reports() != ()


def test_showing_the_plant_does_not_change_it():
    car = plant(initial_speed=10.0)
    for signals, _ in zip(inputs(2), range(20), strict=False):
        car.advance(*signals)
        before = car.state.tobytes()
        car.outputs()
        assert car.state.tobytes() == before


def test_every_number_has_a_name():
    """Those of the integrator come first, in its order."""
    given = names(PlanarState())
    assert len(given) == len(set(given)) == len(plant().state)
    assert given[: len(INTEGRATED_PLACES)] == [place.name for place in INTEGRATED_PLACES]
    assert given[index("motor_heat")] == "motor_heat.front_left"
