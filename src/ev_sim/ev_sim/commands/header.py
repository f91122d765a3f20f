"""ev-stack header: the C interface of laws."""

from __future__ import annotations

from ev_core.native.header import header


def main(argv: list[str] | None = None) -> None:
    """ev-stack header"""
    print(header(), end="")
