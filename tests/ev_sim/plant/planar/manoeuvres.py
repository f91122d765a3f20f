"""Manoeuvres of four seconds."""

from __future__ import annotations

import numpy as np
from plant.planar.car import STRAIGHT, command, on, plant, steered

MANOEUVRES = {
    "launch": ({}, lambda t: (command(drive=(400.0, 400.0, 0.0, 0.0)), STRAIGHT)),
    "spinning launch": (
        on("packed_snow_2"),
        lambda t: (command(drive=(500.0, 500.0, 0.0, 0.0)), STRAIGHT),
    ),
    "braking on split friction": (
        {"initial_speed": 20.0, "road__left": ("packed_snow_1",)},
        lambda t: (command(brake=(400.0, 400.0, 200.0, 200.0)), STRAIGHT),
    ),
    "step steer": (
        {"initial_speed": 20.0},
        lambda t: (
            command(drive=(100.0, 100.0, 0.0, 0.0)),
            steered(min(0.2 * max(t - 0.5, 0.0), 0.04)),
        ),
    ),
    "reversing": ({}, lambda t: (command(drive=(-200.0, -200.0, 0.0, 0.0)), steered(0.2))),
    "stop and go": (
        {"initial_speed": 5.0},
        lambda t: (
            command(brake=(500.0,) * 4) if t < 1.5 else command(drive=(150.0, 150.0, 0.0, 0.0)),
            steered(0.1),
        ),
    ),
    "held speed": (
        {"initial_speed": 10.0, "speed": "held"},
        lambda t: (command(drive=(300.0, 300.0, 0.0, 0.0)), steered(0.05)),
    ),
    "imposed speed": (
        {
            "initial_speed": 4.0,
            "speed": "imposed",
            "imposed_speed__time": (0.0, 2.0, 3.0),
            "imposed_speed__speed": (4.0, 8.0, 7.0),
        },
        lambda t: (command(drive=(300.0, 300.0, 0.0, 0.0)), steered(0.05)),
    ),
    "speed imposed at the wheels": (
        {
            "initial_speed": 4.0,
            "speed": "imposed",
            "imposed_at": "wheels",
            "imposed_speed__time": (0.0, 2.0, 4.0),
            "imposed_speed__speed": (4.0, 8.0, 2.0),
        },
        lambda t: (command(drive=(100.0, 100.0, 0.0, 0.0)), steered(0.05)),
    ),
}


def end_state(step: float, name: str, integrator: str = "runge_kutta") -> np.ndarray:
    parameters, inputs = MANOEUVRES[name]
    car = plant(step=step, integrator=integrator, **parameters)
    for n in range(400):
        car.advance(*inputs(n * 0.01))
    return car.state.copy()
