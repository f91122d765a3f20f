"""The vehicle description that plant, column, driver and laws share."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters import parameter


@dataclass(frozen=True, slots=True)
class Vehicle:
    """Mass, geometry and resistance of a car; the files in config/vehicles give the values and their sources.

    The defaults are the Audi A2 of Shchur (2019).
    """

    name: str = parameter("audi_a2", about="name of the vehicle file")
    mass: float = parameter(1400.0, unit="kg", low=50.0, high=60000.0, about="mass with load, m")
    wheelbase: float = parameter(2.405, unit="m", low=0.3, high=12.0, about="distance of the axles, L")
    front_track: float = parameter(1.462, unit="m", low=0.2, high=4.0, about="distance of the front wheels, d")
    rear_track: float = parameter(1.462, unit="m", low=0.2, high=4.0, about="distance of the rear wheels")
    centre_of_mass_to_rear_axle: float = parameter(
        1.08225, unit="m", low=0.0, high=12.0, about="centre of mass in front of the rear axle, l_cm L"
    )
    wheel_radius: float = parameter(0.294, unit="m", low=0.05, high=1.5, about="rolling radius of the wheels, r_k")
    steering_ratio: float = parameter(
        16.0, unit="1", low=1.0, high=40.0, about="steering-wheel angle over road-wheel angle, i"
    )
    gear_ratio: float = parameter(2.65, unit="1", low=0.1, high=50.0, about="motor speed over wheel speed")
    driven_wheels: tuple[str, ...] = parameter(
        ("front_left", "front_right"),
        choices=("front_left", "front_right", "rear_left", "rear_right"),
        about="wheels with a motor",
    )
    rolling_resistance: float = parameter(
        0.015, unit="1", low=0.0, high=0.5, about="rolling resistance coefficient, k_r or f_0"
    )
    drag_coefficient: float = parameter(0.3, unit="1", low=0.0, high=3.0, about="aerodynamic drag coefficient, c_d")
    frontal_area: float = parameter(2.1, unit="m^2", low=0.0, high=20.0, about="frontal area, A")
    air_density: float = parameter(1.24, unit="kg/m^3", low=0.0, high=2.0, about="density of the air, rho")
