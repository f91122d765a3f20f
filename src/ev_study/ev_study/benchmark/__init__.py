"""The benchmark of torque control: boards, seeded draws, runs in batches, kept on disk (docs/benchmark.md)."""
