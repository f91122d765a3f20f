"""Registers the gateways to the inverters."""

import ev_bench.inverter_gateway.can  # noqa: F401
