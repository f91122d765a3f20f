"""The benchmark of torque control: boards, seeded draws, runs in batches, costs, ranks (docs/benchmark.md)."""
