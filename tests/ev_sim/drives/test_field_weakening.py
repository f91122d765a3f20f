"""Torque envelope of a synchronous machine by DC voltage and speed, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ev_bench.inverter.device import Inverter, InverterParameters
from ev_bench.inverter.power_stage import advance_torque
from ev_core.vehicle.losses import loss_power
from ev_core.vehicle.motor import Motor, Winding
from ev_msgs_py.can.drive_states import OPERATION_ENABLED
from ev_msgs_py.can.frames import TORQUE_MODE
from ev_sim.drives.synchronous_motor import (
    phase_values,
    torque_per_current,
    voltage_limited_torque,
    weakening_loss,
)

VOLTAGE = 659.2  # 206 cells at 3.2 V
LAZY = Winding(inductance=3e-5)  # psi > L I: its speed has an end
EAGER = Winding()  # psi < L I: beyond some speed the voltage alone decides
BOTH = pytest.mark.parametrize("winding", [LAZY, EAGER])


def amplitude(winding: Winding) -> float:
    return math.sqrt(2.0) * winding.largest_current


def limit(winding: Winding, voltage: float) -> float:
    """Largest amplitude of the phase voltage [V]."""
    return winding.voltage_share * voltage / math.sqrt(3.0)


@BOTH
def test_torque_falls_from_the_base_speed_on(winding):
    """w_b = U/(p sqrt(psi^2 + (L I)^2)); the full torque is 3/2 p psi I.

    The margin of 1e-6 is far above rounding.
    """
    most = 1.5 * winding.pole_pairs * winding.flux_linkage * amplitude(winding)
    linkage = math.hypot(winding.flux_linkage, winding.inductance * amplitude(winding))
    base = limit(winding, VOLTAGE) / (winding.pole_pairs * linkage)
    for below in (0.0, 0.5 * base, base * (1.0 - 1e-6)):
        assert voltage_limited_torque(winding, VOLTAGE, below) == pytest.approx(most, rel=1e-12)
    assert voltage_limited_torque(winding, VOLTAGE, base * (1.0 + 1e-6)) < most


def test_the_speed_ends_where_the_current_cannot_weaken_the_magnets_enough():
    """w_max = U/(p (psi - L I)), i_d = -I.

    The root's slope there is infinite, so 1e-6 before it 0.3 % is left.
    """
    end = limit(LAZY, VOLTAGE) / (
        LAZY.pole_pairs * (LAZY.flux_linkage - LAZY.inductance * amplitude(LAZY))
    )
    assert 0.0 < voltage_limited_torque(LAZY, VOLTAGE, end * (1.0 - 1e-6)) < 0.01 * 360.0
    assert voltage_limited_torque(LAZY, VOLTAGE, end * (1.0 + 1e-6)) == 0.0


@BOTH
@pytest.mark.parametrize("speed", [300.0, 600.0, 785.0, 1500.0, 4000.0])
def test_it_is_the_most_that_both_circles_leave(winding, speed):
    """Over a grid of 100 001 i_d the best i_q comes within the square of the grid's step.

    1e-6 of the current.
    """
    direct = np.linspace(-amplitude(winding), 0.0, 100_001)
    reach = limit(winding, VOLTAGE) / (winding.pole_pairs * speed)
    held = winding.flux_linkage + winding.inductance * direct
    squared = np.minimum(
        amplitude(winding) ** 2 - direct**2, (reach**2 - held**2) / winding.inductance**2
    )
    best = torque_per_current(winding) * math.sqrt(max(float(squared.max()), 0.0))
    assert voltage_limited_torque(winding, VOLTAGE, speed) == pytest.approx(
        best, rel=1e-4, abs=1e-9
    )
    assert voltage_limited_torque(winding, VOLTAGE, -speed) == voltage_limited_torque(
        winding, VOLTAGE, speed
    )


@BOTH
def test_speed_scales_with_the_voltage(winding):
    """Both circles know the voltage only as U/w."""
    for speed in (200.0, 500.0, 785.0):
        whole = voltage_limited_torque(winding, VOLTAGE, speed)
        assert voltage_limited_torque(winding, 0.5 * VOLTAGE, 0.5 * speed) == pytest.approx(
            whole, rel=1e-12
        )


@BOTH
def test_the_envelope_has_no_jump_and_never_rises(winding):
    """Steps of 0.05 rad/s.

    A jump would be far above 3 N m, the steepest fall is just before the end of the speed.
    """
    speeds = np.arange(0.0, 3000.0, 0.05)
    torques = np.array([voltage_limited_torque(winding, VOLTAGE, speed) for speed in speeds])
    falls = -np.diff(torques)
    assert falls.min() >= -1e-9
    assert falls.max() < 3.0


def test_within_the_envelope_current_and_voltage_keep_their_limits():
    """But for the resistance's share of the voltage, for which `voltage_share` leaves room."""
    motor = Motor(winding=EAGER, copper_loss=0.045)
    for speed in (0.0, 100.0, 500.0, 785.0, 1500.0):
        most = voltage_limited_torque(EAGER, VOLTAGE, speed)
        for torque in np.linspace(-most, most, 9):
            current, voltage = phase_values(motor, torque, VOLTAGE, speed)
            assert current <= EAGER.largest_current * (1.0 + 1e-9)
            assert voltage <= VOLTAGE / math.sqrt(6.0)


def test_phase_power_is_mechanical_power_and_copper_loss():
    """A current across the magnets alone has the apparent power 3 U I.

    Its active part is T w + k T^2.
    """
    motor = Motor(winding=Winding(inductance=1e-6), copper_loss=0.045)
    current, voltage = phase_values(motor, 200.0, VOLTAGE, 100.0)
    reactive = 1.5 * 10 * 100.0 * 1e-6 * 2.0 * current * current  # 3 w_e L I^2
    active = math.sqrt((3.0 * voltage * current) ** 2 - reactive**2)
    assert active == pytest.approx(200.0 * 100.0 + 0.045 * 200.0**2, rel=1e-12)
    assert weakening_loss(motor, 200.0, VOLTAGE, 100.0) == 0.0
    assert weakening_loss(motor, 50.0, 0.5 * VOLTAGE, 785.0) > 0.0


@pytest.mark.parametrize("asked", [360.0, -360.0])
def test_an_inverter_keeps_to_the_envelope_of_its_dc_link(asked):
    """Torque is the envelope at 329.6 V and 7000 rpm behind the lag.

    DC current is all power over the voltage.
    """
    p, s, speed = InverterParameters(), Inverter(), 733.0
    s.state, s.dc_link.voltage = float(OPERATION_ENABLED), 0.5 * VOLTAGE
    s.command.mode, s.command.torque, s.command.torque_limit, s.command.speed = (
        float(TORQUE_MODE),
        asked,
        360.0,
        1e3,
    )
    advance_torque(p, s, speed, 1.0)
    machine, most = p.machine, voltage_limited_torque(p.machine.winding, 0.5 * VOLTAGE, speed)
    assert most < min(machine.peak_power, machine.generator_power) / speed
    assert s.torque == pytest.approx(math.copysign(most, asked), rel=1e-12)
    assert s.limited == 1.0
    loss = loss_power(machine, most, speed) + weakening_loss(machine, most, 0.5 * VOLTAGE, speed)
    assert s.dc_current * 0.5 * VOLTAGE == pytest.approx(s.torque * speed + loss, rel=1e-12)
    assert s.phase_current <= machine.winding.largest_current * (1.0 + 1e-9)
