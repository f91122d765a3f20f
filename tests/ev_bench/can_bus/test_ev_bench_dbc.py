"""The database of the bench: its frames, and that tools which are not ours read them as we do."""

from __future__ import annotations

import random

import pytest
from can_bus.databases import by_canmatrix, by_cantools, ours

from documentation.response_times import bus_load, of_layouts
from ev_msgs_py.can.frames import FAULTS, WARNINGS

NAMES = sorted(frame.name for frame in ours())
DEVICES = {"Drive11": 11, "Drive12": 12, "Load11": 21, "Load12": 22}
BIT_RATE = 1e6
GUARDS = ("Crc", "Counter")


def random_values(name: str, random_number: random.Random) -> dict[str, float]:
    return {
        signal: random_number.uniform(f.low, f.high) for signal, f in ours()[name].signals.items()
    }


def test_every_device_has_the_frames_of_its_kind_under_the_identifiers_of_canopen():
    """Predefined connection set of CiA 301: emergency, PDOs, heartbeat by node id."""
    functions = {
        "Faults": 0x080,
        "Motion": 0x180,
        "SetPoint": 0x200,
        "Electrical": 0x280,
        "Temperatures": 0x380,
    }
    expected = {
        f"{device}_{f}": base + node
        for device, node in DEVICES.items()
        for f, base in functions.items()
    }
    assert {frame.name: frame.identifier for frame in ours()} == expected | {"Ecu_Heartbeat": 0x701}


def test_no_two_frames_share_an_identifier_or_a_data_id():
    assert (
        len({frame.identifier for frame in ours()})
        == len({frame.data_id for frame in ours()})
        == len(NAMES)
        == 21
    )


def test_set_points_go_from_the_controller_to_one_device_and_everything_else_to_the_controller():
    for frame in ours():
        device, _, kind = frame.name.partition("_")
        if kind == "SetPoint":
            assert (frame.sender, frame.receivers) == ("Ecu", {device})
        elif device != "Ecu":
            assert (frame.sender, frame.receivers) == (device, {"Ecu"})
        else:
            assert frame.receivers == set(DEVICES)


def test_cycle_times():
    cycles = {
        "SetPoint": 0.001,
        "Motion": 0.001,
        "Electrical": 0.01,
        "Faults": 0.01,
        "Heartbeat": 0.01,
    }
    for frame in ours():
        assert frame.cycle == cycles.get(frame.name.partition("_")[2], 0.1)


@pytest.mark.parametrize("circuit", ["11", "12"])
def test_one_channel_carries_one_circuit_with_every_frame_in_time(circuit: str):
    """One circuit fits at 1 Mbit/s with all stuff bits; two would need more than the whole bus."""
    layouts = [frame for frame in ours() if circuit in frame.name or "Heartbeat" in frame.name]
    assert len(layouts) == 11
    assert bus_load(layouts, BIT_RATE) < 0.65
    for name, time in of_layouts(layouts, BIT_RATE).items():
        assert time < ours()[name].cycle, name
    assert bus_load(ours(), BIT_RATE) > 1.0


def test_ranges_hold_what_the_devices_measure_and_steps_are_finer_than_their_errors():
    """1000 N m, 10000 rpm, 750 V DC and 250 V AC to 0.1 % each, 350 A to 1 %."""
    motion, electrical = ours()["Drive11_Motion"].signals, ours()["Drive11_Electrical"].signals
    heat = ours()["Drive11_Temperatures"].signals["CoolantIn"]
    for field, range_, error in (
        (motion["Torque"], 1000.0, 1.0),
        (motion["Speed"], 10000.0, 10.0),
        (electrical["DcVoltage"], 750.0, 0.75),
        (electrical["PhaseVoltage"], 250.0, 0.25),
        (electrical["DcCurrent"], 350.0, 3.5),
        (heat, 200.0, 1.0),  # the least of 1 to 2 % at 100 degC
    ):
        assert field.high >= range_
        assert field.scale <= error / 2


def test_units_are_named():
    units = (
        ours()["Drive11_Motion"].units
        | ours()["Drive11_Electrical"].units
        | ours()["Drive11_Temperatures"].units
    )
    assert {units[name] for name in ("Torque", "Speed", "DcVoltage", "DcCurrent", "Winding", "CoolantFlow")} == {
        "N m", "rpm", "V", "A", "degC", "l/min"
    }  # fmt: skip


def test_every_signal_that_is_no_guard_and_no_word_is_explained():
    for message in by_cantools().messages:
        assert message.comment
        for signal in message.signals:
            explained = signal.comment or signal.unit
            assert explained, f"{message.name}.{signal.name}"


@pytest.mark.parametrize("device", DEVICES)
def test_faults_and_warnings_are_those_of_the_code(device: str):
    signals = ours()[f"{device}_Faults"].signals
    places = {
        name: (field.start, field.length) for name, field in signals.items() if name != "ErrorCode"
    }
    faults = {fault.name: (32.0 + place, 1.0) for place, fault in enumerate(FAULTS)}
    assert places == faults | {name: (48.0 + place, 1.0) for place, name in enumerate(WARNINGS)}
    choices = (
        by_cantools()
        .get_message_by_name(f"{device}_Faults")
        .get_signal_by_name("ErrorCode")
        .choices
    )
    assert {code: str(text) for code, text in choices.items()} == {0: "no fault"} | {
        f.code: f.about for f in FAULTS
    }


@pytest.mark.parametrize("name", NAMES)
def test_cantools_and_canmatrix_read_our_frames_as_we_mean_them(name: str):
    """Random values.

    Half a step at most from what was meant, and the same number in all three, to rounding.
    """
    frame, numbers = ours()[name], random.Random(name)
    for _ in range(50):
        values = random_values(name, numbers)
        data = frame.pack(values, counter=3)
        own = frame.values(int.from_bytes(data, "little"))
        cantools_ = by_cantools().decode_message(frame.identifier, data, decode_choices=False)
        canmatrix_ = by_canmatrix().frame_by_name(name).decode(data)
        assert cantools_["Counter"] == canmatrix_["Counter"].raw_value == 3
        for signal, field in frame.signals.items():
            assert abs(own[signal] - values[signal]) <= field.scale / 2 * (1 + 1e-9)
            assert float(cantools_[signal]) == pytest.approx(own[signal], rel=1e-14, abs=1e-13)
            assert float(canmatrix_[signal].phys_value) == pytest.approx(
                own[signal], rel=1e-14, abs=1e-13
            )


@pytest.mark.parametrize("name", NAMES)
def test_we_read_the_frames_of_cantools_and_canmatrix(name: str):
    frame, numbers = ours()[name], random.Random(name)
    for _ in range(50):
        raw = {s: numbers.randint(round((f.low - f.offset) / f.scale), round((f.high - f.offset) / f.scale))
               for s, f in frame.signals.items()}  # fmt: skip
        values = {
            s: frame.signals[s].offset + frame.signals[s].scale * number
            for s, number in raw.items()
        }
        guards = dict.fromkeys(GUARDS, 0)
        for data in (
            by_cantools().encode_message(frame.identifier, values | guards, strict=True),
            by_canmatrix().frame_by_name(name).encode(raw | guards),  # takes whole numbers of steps
        ):
            assert frame.values(int.from_bytes(data, "little")) == pytest.approx(values, rel=1e-14)


def test_both_tools_see_the_same_cycle_times_senders_and_comments():
    for message in by_cantools().messages:
        other = by_canmatrix().frame_by_name(message.name)
        assert (message.cycle_time, message.senders, message.comment) == (
            other.cycle_time, other.transmitters, other.comment
        )  # fmt: skip
