"""Load machines at constant torque or speed, whatever the virtual car asks for (section 4.2)."""

from __future__ import annotations

import math

import pytest

import ev_stack

GEAR, FRICTION = 7.4, 0.002  # of the car, of the bearings [N m s/rad]
INERTIA = 0.02 + 0.1  # of both rotors [kg m^2]
CAN = {"test_bench": "circuits_on_can", "inverter_gateway": "can"}


class Shafts:
    """The two circuits of the scenario with a torque [N m] of both machines under test."""

    def __init__(
        self,
        follows: str,
        left: float,
        right: float,
        torque: float,
        seconds: float = 3.0,
        **changed,
    ) -> None:
        changes = {
            f"plant.load.{follows}_left": left,
            f"plant.load.{follows}_right": right,
            "driver.pedals.drive_torque": [0.0, 2.0 * GEAR * torque],
        } | {name.replace("__", "."): value for name, value in changed.pop("set", {}).items()}
        run = f"constant_{follows}"
        done = ev_stack.run("bench_load", runs=(run,), duration=seconds, set=changes, **changed)
        self.time, self.channels = done.time, done.runs[run].channels
        self.vehicle = done.scenario.runs[0].configurations["plant"].common.vehicle

    def at(self, time: float, name: str, side: str = "left") -> float:
        """A channel of bench/shafts at a time [s]."""
        return float(self.channels[f"bench.shafts.{name}.front_{side}"][round(time / 0.005)])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_constant_torque_accelerates_by_what_is_left(sign):
    """(50 - 38)/0.12 = 100 rad/s^2 from rest, both ways, and 60 rad/s^2 against 42.8 N m.

    Between 1 s and 2 s, when torques have settled; no friction. The road of the virtual car asks
    for something else.
    """
    shafts = Shafts(
        "torque", 38.0 * sign, 42.8 * sign, 50.0 * sign, set={"test_bench__shaft__friction": 0.0}
    )
    for side, acceleration in (("left", 100.0), ("right", 60.0)):
        gained = shafts.at(2.0, "speed", side) - shafts.at(1.0, "speed", side)
        assert gained == pytest.approx(sign * acceleration, rel=1e-6)
    assert shafts.at(2.0, "load_torque") == pytest.approx(-38.0 * sign, rel=1e-9)
    # behind the rotor
    assert shafts.at(2.0, "torque") == pytest.approx(sign * (50.0 - 0.02 * 100.0), rel=1e-6)


def test_a_load_machine_alone_turns_the_bench_up_to_its_largest_speed():
    """Alone, it accelerates by M_nu/(J_1 + J_2) less the bearings, to 1047 rad/s and no more.

    Backwards here: w = M/b (1 - exp(-b t/J)); the lag of the torque of 1 ms and the exchange of 5
    ms of 0.5 s leave 2 %.
    """
    shafts = Shafts("torque", 60.0, 0.0, 0.0, 6.0)
    expected = -60.0 / FRICTION * (1.0 - math.exp(-FRICTION / INERTIA * 0.5))
    assert shafts.at(0.5, "speed") == pytest.approx(expected, rel=0.02)
    assert shafts.at(6.0, "speed", "right") == 0.0
    assert -1047.0 < shafts.at(6.0, "load_speed") < -1000.0


def test_a_torque_beyond_the_machine_is_what_the_machine_can():
    """A command of 600 N m gives 400 N m at the shaft, below the speed where power limits it."""
    shafts = Shafts("torque", 600.0, -600.0, 0.0, 0.1)
    assert (
        shafts.at(0.05, "load_torque"),
        shafts.at(0.05, "load_torque", "right"),
    ) == pytest.approx((-400.0, 400.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_constant_speed_is_reached_at_its_rate_and_held(sign):
    """200 rad/s^2 from rest give 200 rad/s after 1 s, and 50 N m of the other machine move nothing.

    While it rises the speed is late by the exchange of 5 ms, 1 rad/s, and by what its gain of 60 N
    m s/rad needs for the torques, 1 rad/s. At rest it is rounded to 0.5 rpm, 0.026 rad/s to either
    side. The load machine takes the torque but for the friction of the bearings, 0.4 N m; 1 s are
    20 of its integral times.
    """
    shafts = Shafts("speed", 200.0 * sign, 100.0 * sign, 50.0 * sign)
    assert shafts.at(0.5, "load_speed") == pytest.approx(100.0 * sign, abs=2.0)
    assert shafts.at(3.0, "load_speed") == pytest.approx(200.0 * sign, abs=0.027)
    assert shafts.at(3.0, "load_speed", "right") == pytest.approx(100.0 * sign, abs=0.027)
    assert shafts.at(3.0, "torque") == pytest.approx(50.0 * sign, rel=1e-4)
    assert shafts.at(3.0, "load_torque") == pytest.approx(
        sign * (FRICTION * 200.0 - 50.0), rel=1e-4
    )


def test_a_speed_gives_way_where_the_load_machine_ends():
    """40 N m hold back no 60 N m.

    20 N m less 0.002 w turn 0.12 kg m^2 beyond the speed that was asked for.
    """
    ends = {"test_bench__load__machine__generator_torque": 40.0}
    shafts = Shafts("speed", 50.0, 50.0, 60.0, set=ends)
    before = shafts.at(1.0, "speed")
    expected = before + (20.0 / FRICTION - before) * (1.0 - math.exp(-FRICTION / INERTIA * 1.0))
    assert shafts.at(2.0, "speed") == pytest.approx(expected, rel=1e-4)


def test_a_wheel_may_turn_as_its_load_machine_does():
    """`wheel_speed: load_machine` makes 150 rad/s at the shafts 20.27 rad/s at the wheels, 6.5 m/s.

    The wheel begins each exchange of 5 ms with that speed, and until the next one its tyre draws it
    towards rolling: that is the slip at which it carries what the car's resistances take, below 1
    %, half of it in the mean.
    """
    shafts = Shafts("speed", 150.0, 150.0, 0.0, 10.0, set={"plant__wheel_speed": "load_machine"})
    assert shafts.channels["wheel_states.velocity.front_left"][-1] == pytest.approx(
        150.0 / GEAR, rel=0.01
    )
    assert shafts.channels["twist.longitudinal"][-1] == pytest.approx(
        0.320 * 150.0 / GEAR, rel=0.01
    )


@pytest.mark.parametrize(
    ("follows", "left", "right"), [("torque", 60.0, 57.0), ("speed", 300.0, 150.0)]
)
def test_behind_a_bus_load_machines_follow_it_as_well(follows, left, right):
    """When the drives are enabled, within 3 s.

    Torques come in steps of 1/32 N m, speeds in such of 0.5 rpm.
    """
    shafts = Shafts(follows, left, right, 60.0, 6.0, method=CAN)
    name, sign = ("load_torque", -1.0) if follows == "torque" else ("load_speed", 1.0)
    for side, constant in (("left", left), ("right", right)):
        assert shafts.at(6.0, name, side) == pytest.approx(sign * constant, abs=0.06)
    assert shafts.at(6.0, "machine_torque") == pytest.approx(60.0, abs=0.06)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_behind_a_bus_a_load_machine_turns_no_faster_than_the_gateway_lets_it(sign):
    """60 N m on 0.12 kg m^2 against bearings alone: 500 rad/s^2 up to the frames' 100 rad/s.

    The torque fades below the limit, over a share of the machine's largest speed, and bearings take
    0.2 N m: the shaft comes near. Without the limit of the frames it would come to 1046 rad/s.
    """
    quick = {f"test_bench__{of}dc_link__precharge_resistance": 20.0 for of in ("", "load__")}
    ends = {**quick, "inverter_gateway__speed_limit": 100.0}
    shafts = Shafts("torque", -60.0 * sign, 60.0 * sign, 0.0, 3.0, method=CAN, set=ends)
    for side, sense in (("left", sign), ("right", -sign)):
        speed = sense * shafts.channels[f"bench.shafts.load_speed.front_{side}"]
        assert shafts.at(3.0, "load_speed", side) * sense > 80.0
        assert speed.max() < 100.0


def test_by_default_they_follow_the_road():
    """The shafts turn as the rolling wheels do."""
    shafts = Shafts("speed", 300.0, 150.0, 50.0, set={"plant__load__follows": "road"})
    turns = shafts.channels["wheel_states.velocity.front_left"][-1] * GEAR
    # late by the exchange of 5 ms
    assert shafts.at(3.0, "load_speed") == pytest.approx(turns, rel=0.01)
    assert shafts.at(3.0, "load_speed") != pytest.approx(300.0, rel=0.1)


def test_the_load_is_that_of_a_wheel_whose_radius_shrinks_under_its_load():
    """M = r (F_x + f N)/i with r = 0.32 m - c (N - N_static), on which the plant rolls as well.

    Driving takes 1.2 kN from the front wheels: with 1e-5 m/N, far softer than a tyre, they are
    11 mm larger. With 0.32 m the rolling resistance f would be less than none.
    """
    values = {
        "plant__load__follows": "road",
        "*__vehicle__tyre__radius_over_load": 1e-5,
        "*__vehicle__centre_of_mass_height": 1.5,
    }
    shafts = Shafts("speed", 0.0, 0.0, 300.0, set=values)
    names = ("tire_forces.longitudinal_force", "tire_forces.load", "bench.load_command.torque")
    force, load, torque = (float(shafts.channels[f"{name}.front_left"][-1]) for name in names)
    static = 0.5 * shafts.vehicle.front_load_share * shafts.vehicle.mass * 9.81
    radius = 0.32 - 1e-5 * (load - static)
    assert radius > 0.33
    resistance = (torque * GEAR / radius - force) / load
    # f_0, which grows by some per cent with the speed.
    assert resistance == pytest.approx(0.012, rel=0.05)
