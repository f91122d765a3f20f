"""Least squares of the curve y = A x + B sqrt(x) over the last samples (dissertation, eq 2.36)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field


@dataclass(slots=True)
class SlipCurveFit:
    """The last `size` samples of slip x [1] and torque y [1], and the sums of the normal equations.

    The square root is taken of x + `offset`: its slope at zero stays finite, and x = 0 does no harm. x below zero
    counts as zero. A sum that gains and loses a sample each time collects rounding errors, so it is formed anew each
    time the ring of samples is full.
    """

    size: int = 25
    offset: float = 1e-4
    samples: list[tuple[float, float, float]] = field(default_factory=list)  # x, root of x + offset, y
    next: int = 0
    sum_x: float = 0.0
    sum_xx: float = 0.0
    sum_x_root: float = 0.0
    sum_xy: float = 0.0
    sum_root_y: float = 0.0

    def add(self, x: float, y: float) -> None:
        """Take one sample in, and the oldest one out where the window is full."""
        x = max(x, 0.0)
        root = math.sqrt(x + self.offset)
        old_x = old_root = old_y = 0.0
        if len(self.samples) < self.size:
            self.samples.append((x, root, y))
        else:
            old_x, old_root, old_y = self.samples[self.next]
            self.samples[self.next] = (x, root, y)
            self.next += 1
            if self.next == self.size:
                self._begin_ring_anew()
                return
        self.sum_x = self.sum_x - old_x + x
        self.sum_xx = self.sum_xx - old_x * old_x + x * x
        self.sum_x_root = self.sum_x_root - old_x * old_root + x * root
        self.sum_xy = self.sum_xy - old_x * old_y + x * y
        self.sum_root_y = self.sum_root_y - old_root * old_y + root * y

    def _begin_ring_anew(self) -> None:
        self.next, samples = 0, self.samples
        self.sum_x = math.fsum([x for x, _, _ in samples])
        self.sum_xx = math.fsum([x * x for x, _, _ in samples])
        self.sum_x_root = math.fsum([x * root for x, root, _ in samples])
        self.sum_xy = math.fsum([x * y for x, _, y in samples])
        self.sum_root_y = math.fsum([root * y for _, root, y in samples])

    @property
    def is_full(self) -> bool:
        """Whether the window has all its samples."""
        return len(self.samples) == self.size

    @property
    def mean(self) -> float:
        """Mean slip [1] of a full window."""
        return self.sum_x / self.size

    @property
    def variance(self) -> float:
        """Mean squared deviation of the slip [1] of a full window."""
        return self.sum_xx / self.size - (self.sum_x / self.size) ** 2

    def coefficients(self) -> tuple[float, float] | None:
        """A and B of the least squared error, None where the samples lie too close together to tell them apart."""
        sum_of_roots = self.sum_x + len(self.samples) * self.offset
        determinant = self.sum_xx * sum_of_roots - self.sum_x_root * self.sum_x_root
        if determinant <= 1e-9 * self.sum_xx * sum_of_roots:
            return None
        a = (self.sum_xy * sum_of_roots - self.sum_root_y * self.sum_x_root) / determinant
        b = (self.sum_xx * self.sum_root_y - self.sum_x_root * self.sum_xy) / determinant
        return a, b

    def peak(self) -> float | None:
        """Slip at which the fitted curve turns down, (B/(2 A))^2 [1], None where it rises throughout."""
        found = self.coefficients()
        if found is None or found[0] >= 0.0:
            return None
        a, b = found
        return max((b / (2 * a)) ** 2 - self.offset, 0.0) if b > 0.0 else 0.0
