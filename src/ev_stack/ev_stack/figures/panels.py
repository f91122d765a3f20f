"""Panels of a figure: curves over time or over another quantity, beside those of the source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import unknown_name
from ev_stack.figures.strokes import PUBLISHED, Stroke
from ev_stack.figures.thinning import chatter, thinned
from ev_stack.measures import motion
from ev_stack.measures.handling import has_spun
from ev_stack.measures.metric import NotMeasured, Runs, channel
from ev_stack.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
else:
    Axes = Any

DPI = 150  # of figures for the screen, and how finely a curve is drawn in print
BAND = "band: lowest to highest, line: mean"
_ALIKE = 0.003  # share of the ordinate below which two curves are one line
_PIECE = 4.0  # of each of them, where they are drawn in turns [pt]


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Samples (n,) over time (n,) [s]; the label names the curve where a panel holds several.

    `published`: from the source, not from a run.
    """

    time: np.ndarray
    values: np.ndarray
    label: str = ""
    published: bool = False
    # of a run in which the car has spun: other curves set the limits of the axes
    spun: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One pair of axes: `ylabel` gives quantity and unit, `note` why there is nothing to see.

    Panels of a sheet with the same `scale` have the same ordinate. `within`: the ends beyond which
    a curve may leave the panel, so that the others are seen; `ends`: those of the ordinate, None
    where the curves give them. `ground` draws what lies below the curves, or all there is; what it
    labels stands in the legend. `xlabel` is that of the sheet if it is empty. `shape`: height over
    width, 0 for that of curves over time.
    """

    title: str
    ylabel: str
    curves: Sequence[Curve] = ()
    note: str = ""
    scale: str = ""
    within: tuple[float, float] | None = None
    ends: tuple[float | None, float | None] = (None, None)
    ground: Callable[[Axes], None] | None = None
    xlabel: str = ""
    shape: float = 0.0

    @property
    def is_empty(self) -> bool:
        """Mark of a panel that would show nothing."""
        return not (self.curves or self.note or self.ground)

    @property
    def span(self) -> tuple[float, float] | None:
        """Lowest and highest value that it shows; None where there is none."""
        # A spun car's values would flatten all others; alone they set the limits.
        counted = [curve for curve in self.curves if not curve.spun] or self.curves
        finite = [curve.values[np.isfinite(curve.values)] for curve in counted]
        finite = [values for values in finite if len(values)]
        if not finite:
            return None
        low, high = min(float(v.min()) for v in finite), max(float(v.max()) for v in finite)
        return (max(low, self.within[0]), min(high, self.within[1])) if self.within else (low, high)

    def draw(self, axes: Axes, strokes: Mapping[str, Stroke], width: float) -> None:
        """Draw into axes of a width [inch]; curves in the strokes of their labels."""
        if self.ground:
            self.ground(axes)
        for curve, (colour, dashes) in _in_turns(self, strokes):
            line = {"color": colour, "linestyle": dashes, "label": curve.label or None}
            if self.xlabel:
                axes.plot(curve.time, curve.values, **line)
            else:
                _draw_curve(axes, curve, int(width * DPI), line)
        for number, curve in enumerate(curve for curve in self.curves if curve.published):
            # all that is published is one entry of the legend
            label = "_" if number else curve.label
            axes.plot(curve.time, curve.values, label=label, **PUBLISHED)


def _in_turns(panel: Panel, strokes: Mapping[str, Stroke]) -> list[tuple[Curve, tuple[str, Any]]]:
    """Curves that are not published, with colour and dashes; curves that coincide take turns."""
    lines: list[list[Curve]] = []
    for curve in (each for each in panel.curves if not each.published):
        line = next((line for line in lines if _is_alike(line[0], curve)), None)
        if line is None:
            lines.append([curve])
        else:
            line.append(curve)
    found: list[tuple[Curve, tuple[str, Any]]] = []
    for line in lines:
        # Dashes of _PIECE with gaps for all the others, each shifted by its place: none covers
        # another.
        gap = (len(line) - 1) * _PIECE
        for place, curve in enumerate(line):
            own = strokes[readable(curve.label)]
            turn = (-place * _PIECE % (gap + _PIECE), (_PIECE, gap))
            found.append((curve, own if len(line) == 1 else (own.colour, turn)))
    return found


def _is_alike(one: Curve, other: Curve) -> bool:
    return all(_are_close(*pair) for pair in ((one.time, other.time), (one.values, other.values)))


def _are_close(some: np.ndarray, others: np.ndarray) -> bool:
    finite = some[np.isfinite(some)]
    tolerance = _ALIKE * float(np.ptp(finite)) if len(finite) else 0.0
    return len(some) == len(others) and np.allclose(
        some, others, rtol=0.0, atol=tolerance, equal_nan=True
    )


def _draw_curve(axes: Axes, curve: Curve, columns: int, stroke: dict[str, Any]) -> None:
    """Draw a line, or a band of lowest to highest values where the line would be solid ink."""
    found = chatter(curve.time, curve.values, columns)
    line = curve.values if found is None else found.line
    # Only the extremes of each pixel: a PDF would otherwise hold every sample of a long run.
    axes.plot(*thinned(curve.time, line, columns), dash_capstyle="butt", **stroke)
    if found is None:
        return
    # Steps need a value at the last edge, too; there is one edge more than bins.
    ends = [np.append(each, each[-1]) for each in (found.lowest, found.highest)]
    axes.fill_between(
        found.edges, *ends, step="post", color=stroke["color"], alpha=0.3, linewidth=0.0, label=BAND
    )
    axes.plot(
        found.edges,
        np.append(found.mean, found.mean[-1]),
        drawstyle="steps-post",
        **{**stroke, "label": "_"},
    )


def panel(
    title: str,
    ylabel: str,
    curves: Callable[[], Sequence[Curve]],
    scale: str = "",
    within: tuple[float, float] | None = None,
    ends: tuple[float | None, float | None] = (None, None),
) -> Panel:
    """The panel with these curves, or with the reason why they cannot be computed."""
    try:
        return Panel(title, ylabel, curves(), scale=scale, within=within, ends=ends)
    except NotMeasured as why:
        return Panel(title, ylabel, (), f"not measured: {why}")


def level(value: float, start: float, end: float, label: str = "published") -> Curve:
    """A published number as the line that a curve should keep to from `start` to `end` [s]."""
    return Curve(np.array([start, end]), np.array([value, value]), label, published=True)


Quantity = Callable[[Recording], np.ndarray]


def degrees(quantity: Quantity) -> Quantity:
    """An angle [rad] in degrees, in which all figures have angles and yaw rates."""
    return lambda run: np.degrees(quantity(run))


# Units of numbers that figures have in others, and by what to multiply.
IN_FIGURES = {
    **{
        unit: (unit.replace("rad", "deg"), float(np.degrees(1.0)))
        for unit in ("rad", "rad/s", "rad/s^2", "rad s^2/m")
    },
    **dict.fromkeys(("m/s2", "m/s^2"), ("m/s²", 1.0)),
}

# Title, ordinate and quantity in its unit.
MOTION: dict[str, tuple[str, str, Quantity]] = {
    "steering_wheel_angle": (
        "Steering-wheel angle",
        "angle [deg]",
        degrees(lambda run: channel(run, motion.STEERING_WHEEL_ANGLE)),
    ),
    "road_wheel_angle": (
        "Road-wheel angle",
        "angle [deg]",
        degrees(lambda run: channel(run, motion.ROAD_WHEEL_ANGLE)),
    ),
    "yaw_rate": (
        "Yaw rate",
        "yaw rate [deg/s]",
        degrees(lambda run: channel(run, motion.YAW_RATE)),
    ),
    "lateral_acceleration": (
        "Lateral acceleration",
        "acceleration [m/s²]",
        motion.lateral_acceleration_on_path,
    ),
    "sideslip_angle": ("Sideslip angle", "angle [deg]", degrees(motion.sideslip_in_motion)),
    "speed": ("Speed", "speed [m/s]", motion.path_speed),
}


def readable(run: str) -> str:
    """A run, wheel or law as figures name it."""
    return run.replace("_", " ")


def over_time(
    runs: Runs,
    title: str,
    ylabel: str,
    quantity: Quantity,
    within: tuple[float, float] | None = None,
) -> Panel:
    """A quantity of every run, labelled with the name of the run if there are several."""

    def curves() -> list[Curve]:
        labels = [readable(name) if len(runs) > 1 else "" for name in runs]
        named = zip(labels, runs.values(), strict=True)
        return [Curve(run.time, quantity(run), label, spun=has_spun(run)) for label, run in named]

    return panel(title, ylabel, curves, within=within)


def signal_panels(runs: Runs, names: Sequence[str]) -> list[Panel]:
    """Channels of every run; ParameterError for one that no run has."""
    known = {name for run in runs.values() for name in run.channels}
    units = frame.units()
    panels = []
    for name in names:
        if name not in known:
            raise unknown_name("channel", name, known)
        unit, factor = IN_FIGURES.get(units[name], (units[name], 1.0))

        def scaled(run: Recording, name: str = name, factor: float = factor) -> np.ndarray:
            return factor * channel(run, name)

        panels.append(over_time(runs, name, f"[{unit}]", scaled))
    return panels


def motion_panels(runs: Runs, *names: str) -> list[Panel]:
    """Some quantities of MOTION of every run."""
    return [over_time(runs, *MOTION[name]) for name in names]
