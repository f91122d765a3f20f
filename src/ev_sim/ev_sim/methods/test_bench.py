"""Registers the test benches."""

import ev_sim.test_bench.circuits  # noqa: F401
