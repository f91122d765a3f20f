"""The step response of a second-order system in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SecondOrder:
    """J d'' + b d' + k d = torque, with J [kg m^2], b [N m s/rad] and k [N m/rad]; underdamped."""

    inertia: float
    damping: float
    stiffness: float

    @property
    def damping_ratio(self) -> float:
        """Damping relative to critical damping [1]."""
        return self.damping / (2 * math.sqrt(self.inertia * self.stiffness))

    @property
    def decay(self) -> float:
        """Decay rate of the oscillation [1/s]."""
        return self.damping / (2 * self.inertia)

    @property
    def damped_frequency(self) -> float:
        """Angular frequency of the oscillation [rad/s]."""
        return math.sqrt(self.stiffness / self.inertia - self.decay**2)

    @property
    def overshoot(self) -> float:
        """First peak beyond the steady angle [% of it]."""
        return 100 * self._extreme(1)

    @property
    def peak_time(self) -> float:
        """Time from the step to the first peak, half of the period [s]."""
        return math.pi / self.damped_frequency

    def peak_angle(self, steady: float) -> float:
        """First peak of a step response that ends at `steady`, in its unit."""
        return steady * (1 + self._extreme(1))

    def steady_angle(self, torque: float) -> float:
        """Road-wheel angle under a constant torque about the kingpins [rad]."""
        return torque / self.stiffness

    def deviation(self, time: float) -> float:
        """Step response minus its final value, as a fraction of it, `time` seconds after the step."""
        phase = self.damped_frequency * time
        return -math.exp(-self.decay * time) * (math.cos(phase) + self.decay / self.damped_frequency * math.sin(phase))

    def rate(self, time: float) -> float:
        """Slope of the step response, as a fraction of its final value [1/s]."""
        natural = self.stiffness / self.inertia
        decayed = math.exp(-self.decay * time)
        return decayed * natural / self.damped_frequency * math.sin(self.damped_frequency * time)

    def settling_time(self, band: float) -> float:
        """Time from the step to the last entry into +-band around the final value [s]."""
        half_swing = math.pi / self.damped_frequency
        swing = 0
        while self._extreme(swing + 1) > band:
            swing += 1
        # The deviation falls monotonically from this extreme, the last outside the band, to the next one.
        outside, inside = swing * half_swing, (swing + 1) * half_swing
        edge = math.copysign(band, self.deviation(outside))
        sign = math.copysign(1.0, edge)
        while inside - outside > 1e-12:
            middle = (outside + inside) / 2
            if sign * (self.deviation(middle) - edge) > 0:
                outside = middle
            else:
                inside = middle
        return outside

    def _extreme(self, number: int) -> float:
        """Size of the n-th extreme of the deviation as a fraction of the final value; the 0th is the step itself."""
        return math.exp(-self.decay * number * math.pi / self.damped_frequency)
