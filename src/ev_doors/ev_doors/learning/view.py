"""The car from above with its steered wheels, and its way so far, as an array of pixels."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.recording.recording import Recording
from ev_stack.views.car import PREFIX, view_channels, wheels_of

SIZE = 480  # pixels, either way
_DPI = 100
_AROUND = 12.0  # [m] that are shown in each direction
_OVERHANG = 0.7  # [m] of the body beyond the axles
_TYRE_WIDTH = 0.2  # [m]


def picture(
    car: Vehicle, here: Mapping[str, float], time: float, way: Sequence[tuple[float, float]]
) -> np.ndarray:
    """Draw a car at an instant [s] after a way of points x, y [m]: (SIZE, SIZE, 3) of uint8."""
    # Without pyplot, which would keep every figure and may open a window.
    figure = Figure(figsize=(SIZE / _DPI, SIZE / _DPI), dpi=_DPI)
    axes = figure.add_axes((0.13, 0.11, 0.84, 0.82))
    x, y = here["pose.x"], here["pose.y"]
    heading = 2.0 * math.atan2(here["pose.orientation_z"], here["pose.orientation_w"])
    if way:
        axes.plot(*zip(*way, strict=True), color="tab:blue", linewidth=1.0)
    middle = car.wheelbase / 2.0 - car.centre_of_mass_to_rear_axle
    length = car.wheelbase + 2.0 * _OVERHANG
    width = max(car.front_track, car.rear_track) + _TYRE_WIDTH
    shapes = [(middle, -car.centre_of_mass_offset, 0.0, length, width, "lightgrey")]
    angles = _wheel_angles(car, here)
    for wheel in wheels_of(car):
        shapes.append(
            (wheel.x, wheel.y, angles[wheel.name], 2.0 * wheel.radius, _TYRE_WIDTH, "black")
        )
    for along, across, angle, long, wide, color in shapes:
        corners = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)]) * (long / 2.0, wide / 2.0)
        # Turned about its own centre first, then put to its place, then turned with the car.
        in_car = corners @ _turned(angle) + (along, across)
        axes.add_patch(Polygon(in_car @ _turned(heading) + (x, y), color=color))
    axes.set(
        xlim=(x - _AROUND, x + _AROUND),
        ylim=(y - _AROUND, y + _AROUND),
        xlabel="x [m]",
        ylabel="y [m]",
    )
    speed = math.hypot(here["twist.longitudinal"], here["twist.lateral"])
    axes.set_title(f"{time:.2f} s, {3.6 * speed:.1f} km/h", fontsize="medium")
    pixels = io.BytesIO()
    figure.savefig(pixels, format="rgba")
    # A copy, since what a buffer of bytes holds cannot be written to.
    return np.frombuffer(pixels.getvalue(), np.uint8).reshape(SIZE, SIZE, 4)[..., :3].copy()


def _wheel_angles(car: Vehicle, here: Mapping[str, float]) -> dict[str, float]:
    """Angle of each wheel against the car [rad], as live page and report show it."""
    instant = Recording(np.zeros(1), {name: np.array([value]) for name, value in here.items()})
    shown = view_channels(instant, car)
    return {wheel: float(shown[f"{PREFIX}wheel_angle.{wheel}"][0]) for wheel in WHEEL_NAMES}


def _turned(angle: float) -> np.ndarray:
    """The matrix that turns rows x, y to the left by an angle [rad]."""
    return np.array([(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))])
