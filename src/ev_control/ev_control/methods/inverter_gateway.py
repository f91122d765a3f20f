"""Registers the gateways to the inverters."""

import ev_control.inverter_gateway.in_lockstep  # noqa: F401
