"""The vehicle description that plant, column, driver and laws share."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from ev_msgs_py.parameters import ParameterError, group, parameter


@dataclass(frozen=True, slots=True)
class Tyre:
    """Friction curve, combined slip and carcass of the tyres; all four are alike.

    The carcass values are assumptions: no source gives them, and a passenger-car tyre has about these (relaxation
    lengths of 0.2 to 0.4 m). Steady driving does not depend on them.
    """

    curve: str = parameter(
        "burckhardt",
        choices=("burckhardt", "rational", "two_exponential", "magic_formula", "linear"),
        about="friction curve over slip",
    )
    coefficients: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0, 0.0),
        unit="1",
        low=-50.0,
        high=1000.0,
        about="coefficients on dry asphalt, in the order of the curve (rational: peak, peak slip; two_exponential: "
        "mu_s, S0, S1; magic_formula: B, C, D, E; linear: slope); burckhardt takes those of the surface",
    )
    combined: str = parameter(
        "slip_vector",
        choices=("slip_vector", "uncoupled"),
        about="slip_vector: one curve over the resulting slip; uncoupled: each direction on its own",
    )
    lateral_curve: str = parameter(
        "same", choices=("same", "linear"), about="lateral curve; linear needs `uncoupled` and has no friction limit"
    )
    lateral_ratio: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="lateral over longitudinal slip stiffness of the curve"
    )
    front_cornering_stiffness: float = parameter(
        60000.0, unit="N/rad", low=0.0, high=1e6, about="of each front tyre at its static load, if the curve is linear"
    )
    rear_cornering_stiffness: float = parameter(
        60000.0, unit="N/rad", low=0.0, high=1e6, about="of each rear tyre at its static load, if the curve is linear"
    )
    longitudinal_stiffness: float = parameter(
        350e3, unit="N/m", low=1e4, high=1e7, about="carcass stiffness between rim and contact patch, along the wheel"
    )
    lateral_stiffness: float = parameter(
        200e3, unit="N/m", low=1e4, high=1e7, about="carcass stiffness between rim and contact patch, across the wheel"
    )
    longitudinal_damping_time: float = parameter(
        0.01, unit="s", low=1e-3, high=0.1, about="carcass damping over stiffness, along the wheel"
    )
    lateral_damping_time: float = parameter(
        0.02, unit="s", low=1e-3, high=0.1, about="carcass damping over stiffness, across the wheel"
    )

    def __post_init__(self) -> None:
        if len(self.coefficients) != 4:
            raise ParameterError("coefficients needs four elements (those that the curve does not have are zero)")
        if self.lateral_curve == "linear" and self.combined != "uncoupled":
            raise ParameterError("lateral_curve linear needs combined uncoupled: a line has no share of a slip vector")


@dataclass(frozen=True, slots=True)
class Motor:
    """A torque-controlled motor with its inverter and gear; one for each driven wheel.

    The defaults are assumptions for a small city car's front drive with two motors.
    """

    peak_torque: float = parameter(250.0, unit="N m", low=0.0, high=1e5, about="at the shaft, for a short time")
    nominal_torque: float = parameter(150.0, unit="N m", low=1e-3, high=1e5, about="at the shaft, for ever")
    peak_power: float = parameter(40e3, unit="W", low=1.0, high=1e7, about="mechanical power for a short time")
    overload_time: float = parameter(
        60.0, unit="s", low=0.1, high=1e5, about="thermal time constant that ends the short time"
    )
    maximum_speed: float = parameter(
        1000.0, unit="rad/s", low=1.0, high=1e5, about="of the shaft; no drive torque beyond"
    )
    generator_torque: float = parameter(
        150.0, unit="N m", low=0.0, high=1e5, about="largest torque when the motor feeds the battery"
    )
    generator_power: float = parameter(
        25e3, unit="W", low=0.0, high=1e7, about="largest mechanical power that the motor takes"
    )
    torque_lag: float = parameter(0.005, unit="s", low=1e-4, high=10.0, about="time constant of the torque control")
    rotor_inertia: float = parameter(0.0, unit="kg m^2", low=0.0, high=100.0, about="of one rotor, at the shaft")
    gear_efficiency: float = parameter(1.0, unit="1", low=0.5, high=1.0, about="of the gear, either way")
    copper_loss: float = parameter(
        0.05, unit="W/(N m)^2", low=0.0, high=1e3, about="loss per squared torque: winding resistance"
    )
    iron_loss: float = parameter(
        0.5, unit="W s/rad", low=0.0, high=1e3, about="loss per speed: hysteresis and bearings"
    )
    eddy_loss: float = parameter(
        5e-4, unit="W s^2/rad^2", low=0.0, high=10.0, about="loss per squared speed: eddy currents and windage"
    )
    inverter_loss: float = parameter(20.0, unit="W", low=0.0, high=1e4, about="inverter's loss without torque")
    inverter_torque_loss: float = parameter(
        1.0, unit="W/(N m)", low=0.0, high=100.0, about="inverter's loss per torque: switching and conduction"
    )
    map_speed: tuple[float, ...] = parameter(
        (), unit="rad/s", low=0.0, high=1e5, about="shaft speeds of an efficiency map; empty for the loss model"
    )
    map_torque: tuple[float, ...] = parameter(
        (), unit="N m", low=0.0, high=1e5, about="shaft torques of the efficiency map"
    )
    map_efficiency: tuple[float, ...] = parameter(
        (), unit="1", low=0.01, high=1.0, about="efficiency of motor and inverter, speed by speed (row by row)"
    )
    map_file: str = parameter(
        "",
        about="CSV file with the columns speed_radps or speed_rpm, torque_nm and efficiency, instead of the map; empty "
        "for none",
    )

    def __post_init__(self) -> None:
        if len(self.map_efficiency) != len(self.map_speed) * len(self.map_torque):
            raise ParameterError("map_efficiency needs one element for each pair of map_speed and map_torque")
        for name in ("map_speed", "map_torque"):
            axis = getattr(self, name)
            if len(axis) == 1 or any(b <= a for a, b in pairwise(axis)):
                raise ParameterError(f"{name} needs at least two elements and must rise")


@dataclass(frozen=True, slots=True)
class Driveline:
    """How the drive torque of an axle reaches its wheels."""

    coupling: str = parameter(
        "individual",
        choices=("individual", "open", "limited_slip", "clutch"),
        about="individual: a motor for each driven wheel; open, limited_slip: a motor for each driven axle, with a "
        "differential; clutch: one motor, whose torque clutches share out as commanded",
    )
    preload: float = parameter(
        50.0, unit="N m", low=0.0, high=1e4, about="locking torque of the limited-slip differential at no drive torque"
    )
    locking_ratio: float = parameter(
        0.3, unit="1", low=0.0, high=1.0, about="locking torque over drive torque of the limited-slip differential"
    )
    locking_speed: float = parameter(
        1.0, unit="rad/s", low=0.1, high=100.0, about="speed difference at which 76 % of the locking torque acts"
    )
    clutch_lag: float = parameter(
        0.1, unit="s", low=1e-3, high=10.0, about="time constant of the torque shares", source="Zhileykin 2018"
    )


@dataclass(frozen=True, slots=True)
class Battery:
    """The traction battery: open-circuit voltage over charge, one resistance, limits."""

    open_circuit_voltage: tuple[float, ...] = parameter(
        (432.0, 468.0, 480.0, 492.0, 528.0),
        unit="V",
        low=10.0,
        high=2000.0,
        about="at equally spaced states of charge from empty to full",
    )
    resistance: float = parameter(0.1, unit="ohm", low=1e-6, high=10.0, about="internal resistance")
    capacity: float = parameter(50.0, unit="A h", low=0.1, high=1e4, about="charge between empty and full")
    state_of_charge: float = parameter(0.8, unit="1", low=0.0, high=1.0, about="at the start")
    discharge_power: float = parameter(120e3, unit="W", low=0.0, high=1e7, about="largest power given")
    charge_power: float = parameter(60e3, unit="W", low=0.0, high=1e7, about="largest power taken")
    auxiliary_power: float = parameter(0.0, unit="W", low=0.0, high=1e5, about="steady consumption besides the drives")

    def __post_init__(self) -> None:
        if len(self.open_circuit_voltage) < 2:
            raise ParameterError("open_circuit_voltage needs at least two elements")


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
    rolling_resistance_speed: float = parameter(
        0.0, unit="s^2/m^2", low=0.0, high=1e-3, about="growth of the rolling resistance with V^2, k_f"
    )
    yaw_inertia: float = parameter(1900.0, unit="kg m^2", low=5.0, high=1e6, about="about the vertical axis, J_z")
    centre_of_mass_height: float = parameter(0.55, unit="m", low=0.0, high=4.0, about="above the road, h")
    centre_of_mass_offset: float = parameter(
        0.0, unit="m", low=-2.0, high=2.0, about="centre of mass left of the car's middle"
    )
    front_roll_share: float = parameter(
        0.5, unit="1", low=0.0, high=1.0, about="share of the lateral load transfer that the front axle takes"
    )
    wheel_inertia: float = parameter(1.0, unit="kg m^2", low=1e-3, high=1e4, about="of each wheel, J_w")
    steering_geometry: str = parameter(
        "ackermann", choices=("ackermann", "parallel"), about="road-wheel angles of the two front wheels"
    )
    maximum_road_wheel_angle: float = parameter(
        0.7, unit="rad", low=0.01, high=1.4, about="largest mean road-wheel angle, either way"
    )
    maximum_brake_torque: float = parameter(
        4000.0, unit="N m", low=0.0, high=1e6, about="of the friction brake of each wheel"
    )
    blend_brakes: bool = parameter(
        False, about="serve brake torques by the motors first, as far as their generator limits reach"
    )
    blend_fade_speed: float = parameter(
        10.0, unit="rad/s", low=0.1, high=1e3, about="wheel speed below which motors hand braking back to the brakes"
    )
    tyre: Tyre = group(Tyre)
    motor: Motor = group(Motor)
    driveline: Driveline = group(Driveline)
    battery: Battery = group(Battery)

    def __post_init__(self) -> None:
        if self.centre_of_mass_to_rear_axle > self.wheelbase:
            raise ParameterError("centre_of_mass_to_rear_axle is above wheelbase")
        if abs(self.centre_of_mass_offset) >= min(self.front_track, self.rear_track) / 2:
            raise ParameterError("centre_of_mass_offset lies outside the wheels")

    @property
    def driven_wheel_inertia(self) -> float:
        """Inertia of a driven wheel with its rotor behind the gear, J = J_w + i^2 J_r [kg m^2]."""
        return self.wheel_inertia + self.gear_ratio * self.gear_ratio * self.motor.rotor_inertia
