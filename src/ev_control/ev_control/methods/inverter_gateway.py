"""Registers the gateways to the inverters."""

import ev_control.inverter_gateway.can  # noqa: F401
