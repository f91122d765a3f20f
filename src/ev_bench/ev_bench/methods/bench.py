"""Registers the test benches."""

import ev_bench.machines.circuits
import ev_bench.machines.circuits_on_can  # noqa: F401
