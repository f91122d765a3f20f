"""Registers the traction controls."""

import ev_control.asr.off  # noqa: F401
