"""The vehicle description."""

import math
from dataclasses import dataclass

from ev_core.parameters.declaration import group, own, parameter, setting
from ev_core.vehicle.battery import Battery
from ev_core.vehicle.driveline import Driveline, refuse_drive_train
from ev_core.vehicle.motor import Engine, Motor
from ev_core.vehicle.suspension import RollingBody, Suspension, rolling_body
from ev_core.vehicle.tmeasy import tyre_size
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError

LOAD_TRANSFERS = ("both", "longitudinal", "lateral", "none")
GRAVITY = 9.81  # [m/s^2], as in all sources
# Share that the rolling radius may be off from that of the tyre's size: rules for it differ by 2 %.
_RADIUS_OFF = 0.05


@dataclass(frozen=True, slots=True)
class RoadLoad:
    """Resistance of a car on a level road, A + B V + C V^2, from a coast-down."""

    constant: float = setting(
        0.0,
        unit="N",
        low=0.0,
        high=1e5,
        about="constant part, A, of which each wheel takes the share of its load",
    )
    linear: float = setting(
        0.0, unit="N s/m", low=-100.0, high=1e4, about="part that grows with the speed, B"
    )
    quadratic: float = setting(
        0.0, unit="N s^2/m^2", low=0.0, high=100.0, about="part that grows with its square, C"
    )


@dataclass(frozen=True, slots=True)
class Vehicle:
    """Mass, geometry and resistance of a car.

    The files in config/vehicles give the values and their sources. The defaults are the Audi A2 of
    Shchur (2019).
    """

    name: str = own("audi_a2", about="name of the vehicle file")
    mass: float = own(1400.0, unit="kg", low=50.0, high=60000.0, about="mass with load, m")
    wheelbase: float = own(2.405, unit="m", low=0.3, high=12.0, about="distance of the axles, L")
    front_track: float = own(
        1.462, unit="m", low=0.2, high=4.0, about="distance of the front wheels, d"
    )
    rear_track: float = own(1.462, unit="m", low=0.2, high=4.0, about="distance of the rear wheels")
    centre_of_mass_to_rear_axle: float = own(
        1.08225,
        unit="m",
        low=0.0,
        high=12.0,
        about="centre of mass in front of the rear axle, l_cm L",
    )
    wheel_radius: float = own(
        0.294, unit="m", low=0.05, high=1.5, about="rolling radius of the wheels, r_k"
    )
    wheel_radius_ratio: tuple[float, ...] = parameter(
        (1.0, 1.0, 1.0, 1.0),
        unit="1",
        low=0.5,
        high=2.0,
        about="true radius of each wheel over `wheel_radius`, in the planar plant; laws know "
        "`wheel_radius` alone",
        source="dissertation, chapter 2: r_k,i of the i-th wheel",
        per_wheel=True,
    )
    steering_ratio: float = own(
        16.0, unit="1", low=1.0, high=40.0, about="steering-wheel angle over road-wheel angle, i"
    )
    gear_ratio: float = own(
        2.65, unit="1", low=0.1, high=50.0, about="motor speed over wheel speed"
    )
    driven_wheels: tuple[str, ...] = own(
        ("front_left", "front_right"), choices=WHEEL_NAMES, about="wheels with a motor"
    )
    rolling_resistance: float = own(
        0.015, unit="1", low=0.0, high=0.5, about="rolling resistance coefficient, k_r or f_0"
    )
    drag_coefficient: float = own(
        0.3, unit="1", low=0.0, high=3.0, about="aerodynamic drag coefficient, c_d"
    )
    frontal_area: float = own(2.1, unit="m^2", low=0.0, high=20.0, about="frontal area, A")
    side_drag_coefficient: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=5.0,
        about="drag across the car, of the planar plant, C_wy",
        source="dissertation, eq 2.22, without a value",
    )
    side_area: float = setting(
        0.0, unit="m^2", low=0.0, high=100.0, about="area seen from the side, F_side"
    )
    air_density: float = setting(
        1.24, unit="kg/m^3", low=0.0, high=2.0, about="density of the air, rho"
    )
    rolling_resistance_speed: float = setting(
        0.0,
        unit="s^2/m^2 or h^2/km^2",
        low=0.0,
        high=1e-3,
        about="growth of the rolling resistance with V^2, k_f; the unit by "
        "`rolling_resistance_reading`",
    )
    rolling_resistance_reading: str = parameter(
        "added",
        choices=("added", "relative"),
        about="added: f = f_0 + k_f V^2 with V in m/s; relative: f = f_0 (1 + k_f V^2) with V in "
        "km/h",
        source="dissertation, eq 2.8, which leaves the unit of V open: added is its literal form",
    )
    yaw_inertia: float = own(
        1900.0, unit="kg m^2", low=5.0, high=1e6, about="about the vertical axis, J_z"
    )
    centre_of_mass_height: float = own(0.55, unit="m", low=0.0, high=4.0, about="above the road, h")
    centre_of_mass_offset: float = setting(
        0.0,
        unit="m",
        low=-2.0,
        high=2.0,
        about="centre of mass left of the car's middle",
        lateral=True,
    )
    front_roll_share: float = setting(
        0.5,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the lateral load transfer that the front axle takes, unless `suspension` "
        "has roll stiffness",
    )
    load_transfer: str = parameter(
        "both",
        choices=LOAD_TRANSFERS,
        about="accelerations that move the wheel loads; a source may leave out one of them, or "
        "both",
        source="lateral: Ge & Ni 2005; none: Tatar & Chudzik",
    )
    wheel_inertia: float = own(1.0, unit="kg m^2", low=1e-3, high=1e4, about="of each wheel, J_w")
    undriven_inertia_ratio: float = parameter(
        1.0,
        unit="1",
        low=1e-3,
        high=10.0,
        about="inertia of a wheel without motor over `wheel_inertia`",
        source="Ge & Ni 2005: the front wheels have no equation of motion, as good as no inertia",
    )
    printed_wheel_inertia: bool = parameter(
        False,
        about="add m r_k^2/4 to the inertia of each wheel: the car's mass counts twice",
        source="Tatar & Chudzik, eq 1 as printed",
    )
    steering_geometry: str = setting(
        "ackermann",
        choices=("ackermann", "parallel"),
        about="road-wheel angles of the two front wheels",
    )
    rear_steering_ratio: float = parameter(
        0.0,
        unit="1",
        low=-1.0,
        high=1.0,
        about="angle of both rear wheels over the mean road-wheel angle of the front ones, in the "
        "planar plant",
        source="Ge & Ni 2005, eq 3: delta_r",
    )
    maximum_road_wheel_angle: float = setting(
        0.7, unit="rad", low=0.01, high=1.4, about="largest mean road-wheel angle, either way"
    )
    maximum_brake_torque: float = setting(
        4000.0, unit="N m", low=0.0, high=1e6, about="of the friction brake of each wheel"
    )
    blend_brakes: bool = setting(
        False,
        about="serve brake torques by the motors first, as far as their generator limits reach",
    )
    blend_fade_speed: float = setting(
        10.0,
        unit="rad/s",
        low=0.1,
        high=1e3,
        about="wheel speed below which motors hand braking back to the brakes",
    )
    road_load: RoadLoad = group(RoadLoad)
    suspension: Suspension = group(Suspension)
    tyre: Tyre = group(Tyre)
    motor: Motor = group(Motor)
    driveline: Driveline = group(Driveline)
    engine: Engine = group(Engine)
    battery: Battery = group(Battery)

    def __post_init__(self) -> None:
        if self.centre_of_mass_to_rear_axle > self.wheelbase:
            raise ParameterError("centre_of_mass_to_rear_axle is above wheelbase")
        if abs(self.centre_of_mass_offset) >= min(self.front_track, self.rear_track) / 2:
            raise ParameterError("centre_of_mass_offset lies outside the wheels")
        if len(set(self.driven_wheels)) != len(self.driven_wheels):
            raise ParameterError(
                f"driven_wheels names a wheel twice: {', '.join(self.driven_wheels)}"
            )
        if len(self.wheel_radius_ratio) != 4:
            raise ParameterError("wheel_radius_ratio needs four elements, one for each wheel")
        largest = self.maximum_road_wheel_angle
        across = math.atan2(2.0 * self.wheelbase, self.front_track)
        if self.steering_geometry == "ackermann" and largest >= across:
            raise ParameterError(
                f"maximum_road_wheel_angle: {largest:g} is refused, expected below {across:.4g}, "
                "where by steering_geometry ackermann the inner front wheel stands across the car"
            )
        given = [
            name for name in ("rolling_resistance", "drag_coefficient") if getattr(self, name) > 0.0
        ]
        if given and self.road_load != RoadLoad():
            raise ParameterError(
                f"road_load stands in the place of {' and '.join(given)}, expected 0 for both"
            )
        refuse_drive_train(self)
        if size := self.tyre.estimated_from:
            rolling = tyre_size(size).rolling_radius
            if abs(self.wheel_radius / rolling - 1.0) > _RADIUS_OFF:
                raise ParameterError(
                    f"wheel_radius is {self.wheel_radius:g} m, expected {rolling:.3f} m within "
                    f"{100 * _RADIUS_OFF:g} %, of tyre.estimated_from {size}"
                )
        if self.suspension.has_roll_stiffness:
            if self.centre_of_mass_height <= 0.0:
                raise ParameterError(
                    "suspension.front_roll_stiffness needs centre_of_mass_height above 0"
                )
            if self.suspension.rolls:
                self._refuse_body_that_falls()
            if not 0.0 <= self.front_share_of_roll <= 1.0:
                raise ParameterError(
                    f"suspension gives the front axle {self.front_share_of_roll:.3g} of the "
                    "lateral load transfer, "
                    "expected 0 to 1"
                )

    def _refuse_body_that_falls(self) -> None:
        """Refuse a body that is heavier than the car, or that its springs do not hold upright."""
        sprung = self.suspension.sprung_mass
        if sprung > self.mass:
            raise ParameterError(
                f"suspension.sprung_mass is {sprung:g} kg, expected at most mass, {self.mass:g} kg"
            )
        overturning = self.rolling_body.weight * GRAVITY
        # At twice as much a side force of the weight leans the body by 1 rad, which is no small
        # angle; cars have a fifth of that at most.
        if self.suspension.stiffness < 2.0 * overturning:
            raise ParameterError(
                f"suspension.front_roll_stiffness and rear_roll_stiffness are "
                f"{self.suspension.stiffness:g} N m/rad together, expected at least twice what "
                f"the weight of the body turns it over with, {2.0 * overturning:.5g} N m/rad"
            )

    @property
    def front_load_share(self) -> float:
        """Share of the front axle in the weight [1]."""
        return self.centre_of_mass_to_rear_axle / self.wheelbase

    @property
    def rolling_body(self) -> RollingBody:
        """Constants of the body that rolls on its suspension."""
        heights = (self.centre_of_mass_height, self.wheel_radius)
        return rolling_body(self.suspension, self.mass, heights, self.front_load_share)

    @property
    def front_share_of_roll(self) -> float:
        """Share of the front axle in the lateral load transfer, steady where the body rolls [1]."""
        if not self.suspension.has_roll_stiffness:
            return self.front_roll_share
        if self.suspension.rolls:
            front, rear = self.rolling_body.front_and_rear_moment(self.suspension, GRAVITY)
            return front / (front + rear)
        return self.suspension.front_roll_share(self.centre_of_mass_height, self.front_load_share)

    @property
    def height_of_roll(self) -> float:
        """Height by which a lateral acceleration moves loads, where a body rolls steady [m].

        The weight of a body that rolls moves outwards, so that it is above the centre of mass.
        """
        if not self.suspension.rolls:
            return self.centre_of_mass_height
        return sum(self.rolling_body.front_and_rear_moment(self.suspension, GRAVITY)) / self.mass

    @property
    def rolling_resistance_growth(self) -> float:
        """Growth of the rolling resistance coefficient with the speed, over V^2 [s^2/m^2]."""
        if self.rolling_resistance_reading == "added":
            return self.rolling_resistance_speed
        return self.rolling_resistance * self.rolling_resistance_speed * (3.6 * 3.6)

    @property
    def carried_inertia(self) -> float:
        """Inertia that eq 1 of Tatar & Chudzik adds to each wheel as printed [kg m^2]."""
        return (
            self.mass / 4.0 * self.wheel_radius * self.wheel_radius
            if self.printed_wheel_inertia
            else 0.0
        )
