"""The pedals of standard manoeuvres."""

from __future__ import annotations

from helpers.driving import at, driver_of, state_of

from ev_msgs_py.contract.signals import Instant


def test_pedals_change_over_at_time_and_speed():
    driver = driver_of(
        "manoeuvre",
        pedals__begin=True,
        pedals__begin_time=1.0,
        pedals__begin_speed=10.0,
        pedals__time=[0.0, 1.0],
        pedals__drive_torque=[0.0, 0.0],
        pedals__brake_torque=[0.0, 800.0],
    )

    def has_begun() -> bool:
        return state_of(driver, "manoeuvre")["has_begun"] == 1.0

    assert driver.step(Instant(0.5), at(12.0)).brake_torque != 400.0 and not has_begun()
    driver.step(Instant(1.5), at(9.0))
    assert not has_begun()
    assert driver.step(Instant(2.0), at(11.0)) == (0.0, 0.0, 0.0)
    assert has_begun()
    assert driver.step(Instant(2.5), at(3.0)) == (0.0, 400.0, 0.0)


def test_without_pedals_the_speed_is_followed_throughout():
    """Drives brake to their limit from 11 to 10 m/s, and the brakes do the rest."""
    driver = driver_of("manoeuvre", speed_profile__time=[0.0], speed_profile__speed=[10.0])
    for n in range(3):
        command = driver.step(Instant(n * 1.0), at(11.0))
        assert command.drive_torque == -600.0 and command.brake_torque > 1000.0
    assert state_of(driver, "manoeuvre")["has_begun"] == 0.0
