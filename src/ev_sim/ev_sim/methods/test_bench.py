"""Registers the test benches."""

import ev_sim.test_bench.circuits
import ev_sim.test_bench.circuits_on_can  # noqa: F401
