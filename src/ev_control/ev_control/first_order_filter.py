"""A first-order filter of measured numbers."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.shared.first_order_filter import filter_share  # noqa: F401


@dataclass(slots=True)
class Filtered:
    """A number behind a first-order filter; the first one passes."""

    value: float | None = None

    def follow(self, value: float, share: float) -> float:
        """The filtered number, a share of the gap nearer to this one."""
        self.value = value if self.value is None else self.value + share * (value - self.value)
        return self.value
