"""The table of quantities, and the parameters that follow from it."""

from __future__ import annotations

import zlib

import pytest

from ev_core.lockstep.configuration import configure
from ev_core.parameters.declaration import entries
from ev_core.sensors.measuring import NUMBERS
from ev_core.sensors.row import QUANTITIES, sensors_for
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.optional_signals import (
    BenchEnergy,
    BenchShafts,
    BusStates,
    FeedbackFrames,
    LoadCommand,
)
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import BatteryCondition
from ev_msgs_py.refusal import ParameterError


def test_every_published_number_of_plant_and_column_has_one_sensor():
    """But what is no measurement.

    The battery's capacity, what is commanded on a bench, its energies, and its bus.
    """
    unmeasured = {
        BatteryCondition: ["capacity"],
        LoadCommand: ["mode", "speed", "torque"],
        BenchShafts: ["set_point", "machine_torque", "load_torque"],
        BenchEnergy: list(shape_of(BenchEnergy).fields),
        FeedbackFrames: list(shape_of(FeedbackFrames).fields),
        BusStates: list(shape_of(BusStates).fields),
    }
    for role in ROLES.values():
        for signal in role.writes if role.kind is RoleKind.INTEGRATES else ():
            measured = [
                name
                for quantity in QUANTITIES
                if quantity.signal is signal
                for name in quantity.fields
            ]
            assert sorted([*measured, *unmeasured.get(signal, [])]) == sorted(
                shape_of(signal).fields
            )


def test_numbers_of_one_sensor_have_one_unit():
    for quantity in QUANTITIES:
        # of which the charge is another way to say it
        if quantity.name != "battery_state_of_charge":
            assert (
                len({shape_of(quantity.signal).fields[name].unit for name in quantity.fields}) == 1
            )
    units = {
        entry.name: entry.spec.unit
        for entry in entries(sensors_for(ROLES["plant"].writes), "sensors.")
    }
    assert units["sensors.wheel_speed.noise"] == "rad/s"
    assert units["sensors.body_heading.bias"] == "rad"
    assert units["sensors.battery_state_of_charge.quantisation"] == "1"


def test_every_sensor_draws_other_numbers():
    assert len({zlib.crc32(quantity.name.encode()) for quantity in QUANTITIES}) == len(QUANTITIES)


def test_places_are_those_of_the_fields():
    """Numbers of one sensor stand one after the other.

    Whatever follows from a share stands behind it.
    """
    for quantity in QUANTITIES:
        channels = shape_of(quantity.signal).channels
        names = [
            channels[place - frame.PLACES[quantity.signal].start].split(".")[0]
            for place in quantity.places
        ]
        assert list(dict.fromkeys(names)) == [
            *quantity.fields,
            *([quantity.whole] if quantity.whole else []),
        ]
        if quantity.kind == NUMBERS:
            assert list(quantity.places) == list(
                range(quantity.places[0], quantity.places[0] + quantity.count)
            )


def test_sensors_of_signals_that_a_method_does_not_write_are_unused():
    values = {"sensors.tire_load.noise": 10.0, "sensors.wheel_speed.noise": 0.1}
    made = configure("plant", {"method": "kinematic", **values})
    assert made.unused == ("sensors.tire_load.noise",)
    assert not [name for name in made.values() if name.startswith("sensors.tire")]
    assert configure("plant", {"method": "planar", **values}).unused == ()


@pytest.mark.parametrize(
    ("role", "name", "value", "message"),
    [
        (
            "plant",
            "wheel_speed.noise",
            -0.1,
            "sensors.wheel_speed.noise: -0.1 is refused, expected 0 to 100 rad/s",
        ),
        (
            "plant",
            "tire_load.dropout",
            1.5,
            "sensors.tire_load.dropout: 1.5 is refused, expected 0 to 1",
        ),
        (
            "plant",
            "imu_yaw_rate.delay",
            0.5,
            "sensors.imu_yaw_rate.delay: 0.5 is refused, expected a whole number",
        ),
        (
            "plant",
            "wheel_sped.noise",
            0.1,
            "parameter of plant 'sensors.wheel_sped.noise'; did you mean sensors.",
        ),
        (
            "steering_column",
            "wheel_speed.noise",
            0.1,
            "unknown parameter of steering_column 'sensors.wheel_speed.",
        ),
        (
            "driver",
            "wheel_speed.noise",
            0.1,
            "unknown parameter of driver 'sensors.wheel_speed.noise'",
        ),
    ],
)
def test_bad_sensor_parameters_are_refused(role, name, value, message):
    with pytest.raises(ParameterError, match=message):
        configure(role, {f"sensors.{name}": value})
