"""Moving picture of the README: braking with ice under the left wheels, without a law and with one.

How it works: two runs of one scenario are driven offline. Each frame has one strip of road for each
run, seen from above by one camera, which moves with the mean of both cars: so the difference of
their ways is seen. A wheel that slides leaves its track. Frames are drawn at twice their size and
reduced, which smooths the edges, and share one palette of few colours, which keeps the file small.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont

from ev_core.vehicle.description import Vehicle
from ev_stack.interface.driving import run
from ev_stack.measures.motion import heading
from ev_stack.recording.recording import Recording
from ev_stack.views.car import PREFIX, Wheel, view_channels, wheels_of

NAME = "split_friction.gif"
SCENARIO = "blended_brakes"
# by run, from above
STRIPS = {"off": "without a law", "stability": "blended brakes, with stability control"}
BEGIN = 0.5  # s, half a second before the brakes
PERIOD = 0.08  # s between frames, shown in real time
HOLD = 2.5  # s that the last frame stays
SIZE = (900, 300)  # px

_FINE = 2  # frames are drawn so many times larger
_SCALE = 19.0 * _FINE  # px/m
_POSTS = 10  # m between the posts along the road
_LOCKED = 0.5  # of the speed at which the wheel would roll: below it the wheel counts as sliding
_STANDS = 0.05  # m/s
_COLOURS = 24
_ICE, _ASPHALT, _GAP, _TEXT = "#d3e6f3", "#8a8f96", "#ffffff", "#1b1f24"
_TRACK, _TYRE = "#3c4047", "#14161a"
BODIES = ("#d9572b", "#1f7a8c")


@dataclass(frozen=True, slots=True)
class Driven:
    """Motion of one run: place [m], heading [rad] and speed [m/s] over time, and what its wheels do."""

    time: np.ndarray  # s
    x: np.ndarray  # m from where the brakes begin
    y: np.ndarray
    heading: np.ndarray
    speed: np.ndarray
    wheels: Sequence[Wheel]
    angles: Sequence[np.ndarray]  # of each wheel against the car [rad]
    slides: Sequence[np.ndarray]  # of each wheel, true where it leaves a track

    @property
    def stop(self) -> float:
        """When the car stands for good [s]."""
        return float(self.time[np.flatnonzero(self.speed > _STANDS)[-1]])

    @property
    def way(self) -> float:
        """Distance from where the brakes begin to where the car stands [m]."""
        return float(self.x[-1])

    def at(self, time: float) -> int:
        """Index of an instant."""
        return min(int(np.searchsorted(self.time, time)), len(self.time) - 1)


def drive() -> list[Driven]:
    """Drive the runs of the picture."""
    result = run(SCENARIO, runs=tuple(STRIPS))
    vehicles = {
        each.name: each.configurations["plant"].common.vehicle for each in result.scenario.runs
    }
    return [_driven(result.runs[name], vehicles[name]) for name in STRIPS]


def save_moving_picture(folder: Path, times: Sequence[float] = ()) -> None:
    """Drive and write the picture, of these times [s] or until both cars stand."""
    driven = drive()
    if not times:
        times = np.arange(BEGIN, max(each.stop for each in driven) + PERIOD, PERIOD).tolist()
    drawn = [_frame(driven, time) for time in times]
    palette = drawn[len(drawn) // 2].quantize(_COLOURS, method=Image.Quantize.MAXCOVERAGE)
    first, *others = (each.quantize(palette=palette, dither=Image.Dither.NONE) for each in drawn)
    milliseconds = [round(1000 * PERIOD)] * len(drawn)
    milliseconds[-1] = round(1000 * HOLD)
    first.save(
        folder / NAME,
        save_all=True,
        append_images=others,
        duration=milliseconds,
        loop=0,
        optimize=True,
    )


def _driven(recording: Recording, vehicle: Vehicle) -> Driven:
    channels = recording.channels
    begin = int(np.flatnonzero(channels["driver.command.brake_torque"] > 0.0)[0])
    speed = np.hypot(channels["twist.longitudinal"], channels["twist.lateral"])
    wheels = wheels_of(vehicle)
    seen = view_channels(recording, vehicle)
    rolling = [
        np.abs(channels[f"wheel_states.velocity.{wheel.name}"]) * wheel.radius for wheel in wheels
    ]
    return Driven(
        time=recording.time,
        x=channels["pose.x"] - channels["pose.x"][begin],
        y=channels["pose.y"],
        heading=heading(recording),
        speed=speed,
        wheels=wheels,
        angles=[seen[f"{PREFIX}wheel_angle.{wheel.name}"] for wheel in wheels],
        slides=[(of_wheel < _LOCKED * speed) & (speed > _STANDS) for of_wheel in rolling],
    )


def _frame(driven: Sequence[Driven], time: float) -> Image.Image:
    width, height = (_FINE * each for each in SIZE)
    image = Image.new("RGB", (width, height), _GAP)
    camera = float(np.mean([each.x[each.at(time)] for each in driven]))
    strip_height = height // len(driven)
    for number, (label, each) in enumerate(zip(STRIPS.values(), driven, strict=True)):
        strip = _strip(each, time, camera, label, BODIES[number], (width, strip_height - 3 * _FINE))
        image.paste(strip, (0, number * strip_height))
    return image.resize(SIZE, Image.Resampling.LANCZOS)


def _strip(
    car: Driven, time: float, camera: float, label: str, colour: str, size: tuple[int, int]
) -> Image.Image:
    """The road of one run: ice above, which is on the left of the car, asphalt below."""
    width, height = size
    image = Image.new("RGB", size, _ICE)
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, height // 2, width, height), fill=_ASPHALT)

    def pixel(x: float, y: float) -> tuple[float, float]:
        return width / 2 + (x - camera) * _SCALE, height / 2 - y * _SCALE

    _draw_posts(draw, camera, size)
    now = car.at(time)
    for wheel, slides in zip(car.wheels, car.slides, strict=True):
        for piece in _pieces(slides[: now + 1]):
            line = [pixel(*_on_road(car, i, wheel.x, wheel.y)) for i in piece]
            if len(line) > 1:
                draw.line(line, fill=_TRACK, width=2 * _FINE)
    for corners, fill in _shapes(car, now, colour):
        draw.polygon([pixel(*_on_road(car, now, *corner)) for corner in corners], fill=fill)

    stands = time >= car.stop
    state = f"stands after {car.way:.0f} m" if stands else f"{3.6 * car.speed[now]:.0f} km/h"
    draw.text((10 * _FINE, 6 * _FINE), label, fill=_TEXT, font=_font(15))
    right = width - 10 * _FINE
    draw.text((right, 6 * _FINE), state, fill=_TEXT, font=_font(15), anchor="ra")
    draw.text((right, height / 2 - 4 * _FINE), "ice", fill=_TEXT, font=_font(12), anchor="rs")
    draw.text(
        (right, height / 2 + 4 * _FINE), "dry asphalt", fill=_GAP, font=_font(12), anchor="ra"
    )
    return image


def _draw_posts(draw: ImageDraw.ImageDraw, camera: float, size: tuple[int, int]) -> None:
    """Posts at the edge of the asphalt, with the distance from where the brakes begin."""
    width, height = size
    half = width / 2 / _SCALE
    for post in range(int(camera - half) // _POSTS * _POSTS, int(camera + half) + _POSTS, _POSTS):
        at = width / 2 + (post - camera) * _SCALE
        draw.line((at, height - 8 * _FINE, at, height), fill=_GAP, width=2 * _FINE)
        text = "brakes" if post == 0 else f"{post} m"
        draw.text(
            (at + 5 * _FINE, height - 3 * _FINE), text, fill=_GAP, font=_font(12), anchor="ls"
        )


def _shapes(car: Driven, now: int, colour: str) -> Iterator[tuple[list[tuple[float, float]], str]]:
    """Body, window and wheels, by their corners from the centre of mass, x forward and y left [m]."""
    front, rear = car.wheels[0].x + 0.75, car.wheels[-1].x - 0.7
    half = car.wheels[0].y + 0.12
    yield [(front - 0.35, half), (front, 0.55 * half), (front, -0.55 * half), (front - 0.35, -half),
           (rear, -half), (rear, half)], colour  # fmt: skip
    yield [(front - 1.25, 0.8 * half), (front - 1.75, 0.7 * half), (front - 1.75, -0.7 * half),
           (front - 1.25, -0.8 * half)], _ICE  # fmt: skip
    for wheel, angles in zip(car.wheels, car.angles, strict=True):
        cosine, sine = np.cos(angles[now]), np.sin(angles[now])
        corners = [(wheel.radius * a, 0.11 * b) for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
        yield (
            [
                (wheel.x + a * cosine - b * sine, wheel.y + a * sine + b * cosine)
                for a, b in corners
            ],
            _TYRE,
        )


def _on_road(car: Driven, i: int, forward: float, left: float) -> tuple[float, float]:
    """A point of the car at an instant, on the road [m]."""
    cosine, sine = np.cos(car.heading[i]), np.sin(car.heading[i])
    return car.x[i] + forward * cosine - left * sine, car.y[i] + forward * sine + left * cosine


def _pieces(slides: np.ndarray) -> list[np.ndarray]:
    """The indices of each stretch on which a wheel slides, in one piece; every fourth is enough for a line."""
    at = np.flatnonzero(slides)
    stretches = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
    return [each[::4] for each in stretches]


def _font(size: int) -> ImageFont.FreeTypeFont:
    """The font that matplotlib brings, so that the picture is the same on every machine."""
    return ImageFont.truetype(findfont("DejaVu Sans"), size * _FINE)
