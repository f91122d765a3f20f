"""The frames of the bench's CAN bus, their signals, their faults, and how long they wait."""

from __future__ import annotations

from documentation.markdown import code, table
from documentation.response_times import bus_load, of_layouts
from ev_bench.bus.parameters import load_database
from ev_msgs_py.can.database import FrameLayout
from ev_msgs_py.can.frames import FAULTS
from ev_msgs_py.can.payload import BitField

DEVICE = "Drive11"  # all four devices have the same frames
BIT_RATE = 1e6  # bit/s


def frame_table() -> str:
    """The frames of one circuit, with the longest time until they have arrived."""
    layouts = [
        frame for frame in load_database() if "11" in frame.name or "Heartbeat" in frame.name
    ]
    longest = of_layouts(layouts, BIT_RATE)
    rows = [
        (
            code(frame.name),
            f"{frame.identifier:03X}h",
            code(_other_circuit(frame)),
            f"{frame.cycle * 1e3:g} ms",
            str(frame.length),
            f"{frame.data_id:04X}h",
            f"{longest[frame.name] * 1e3:.3f} ms",
        )
        for frame in sorted(layouts, key=lambda frame: frame.identifier)
    ]
    columns = (
        "frame",
        "identifier",
        "of the left circuit",
        "cycle",
        "bytes",
        "E2E data id",
        "longest response time",
    )
    load = (
        f"Bus load with every frame as long as it can be: {100 * bus_load(layouts, BIT_RATE):.1f} %"
        " of 1 Mbit/s.\n"
    )
    return f"{table(columns, rows)}\n{load}"


def signal_table() -> str:
    """The signals of the frames of one device, and of the controller."""
    rows = [
        (
            code(_kind(frame)),
            code(name),
            _bits(field),
            frame.units[name],
            f"{field.scale:g}",
            _range(field),
        )
        for frame in load_database()
        if frame.name.startswith((DEVICE, "Ecu")) and not frame.name.endswith("Faults")
        for name, field in frame.signals.items()
    ]
    return table(("frame", "signal", "bits", "unit", "step", "range"), rows)


def fault_table() -> str:
    """The faults in the order of their bits."""
    rows = [
        (
            code(fault.name),
            f"byte {4 + place // 8} bit {place % 8}",
            f"{fault.code:04X}h",
            fault.about,
        )
        for place, fault in enumerate(FAULTS)
    ]
    return table(("signal", "place", "`ErrorCode`", "meaning"), rows)


def _kind(frame: FrameLayout) -> str:
    return frame.name.partition("_")[2]


def _other_circuit(frame: FrameLayout) -> str:
    return frame.name.replace("11", "12")


def _bits(field: BitField) -> str:
    first, last = int(field.start), int(field.start + field.length) - 1
    return f"{first}" if first == last else f"{first} to {last}"


def _range(field: BitField) -> str:
    return f"{field.low:g} to {field.high:g}"
