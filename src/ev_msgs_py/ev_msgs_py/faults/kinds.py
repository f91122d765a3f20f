"""What may go wrong: kinds of faults by name, with what their value means."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of fault; its value lies within `low` to `high` in `unit`, and there is none where they are the same."""

    about: str
    unit: str = ""
    low: float = 0.0
    high: float = 0.0

    @property
    def has_value(self) -> bool:
        """Whether a fault of this kind has a value."""
        return self.low < self.high


# Of numbers in messages, wherever they come from: a sensor, its wire, or the bus. In the order of their codes.
OF_SIGNALS = {
    "constant": Kind("shows the value, whatever is true: 0 is a broken wire", "of the number", -1e6, 1e6),
    "scaled": Kind("shows the true number times the value", "1", -100.0, 100.0),
    "offset": Kind("shows the true number plus the value", "of the number", -1e6, 1e6),
    "noisy": Kind("adds Gaussian noise with this standard deviation", "of the number", 0.0, 1e6),
    "tilted": Kind("an accelerometer out of the level by this angle shows a cos + g sin of it", "rad", -1.5, 1.5),
    "swapped": Kind("two numbers, NUMBER,NUMBER, in each other's place"),
    "frozen": Kind("keeps what it showed last"),
    "lost": Kind("is lost with this probability in a period: readers keep the last one", "1", 0.0, 1.0),
    "delayed": Kind("comes so much later, in whole control periods", "s", 1e-4, 10.0),
    "reordered": Kind("with this probability two in a row arrive in the wrong order", "1", 0.0, 1.0),
    "restarted": Kind("the node that writes it is killed, and begins anew when the fault ends; readers keep the last"),
}

# Of the car itself; only a plant that has them knows them.
OF_THE_CAR = {
    "motor_share": Kind("the motor gives this share of what it is asked for: 0 is a dead motor", "1", 0.0, 1.0),
    "motor_stuck": Kind("the motor keeps the torque that it has when the fault begins"),
    "inverter_trip": Kind("asked for more than the value, the inverter switches off", "N m at the shaft", 0.0, 1e5),
    "inverter_delay": Kind("the inverter gets its command later, in whole control periods", "s", 0.0, 0.5),
    "hall_stuck": Kind("one of the three Hall sensors of a brushless motor always shows 1"),
    "battery_share": Kind("the battery's power limits are this share of themselves: 0 is a cut-off", "1", 0.0, 1.0),
    "puncture": Kind("the tyre loses this share of its air", "1", 0.0, 1.0),
}
KINDS = {**OF_SIGNALS, **OF_THE_CAR}
