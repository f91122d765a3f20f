"""Many runs: studies, verdicts, benchmark and tuning, cars held against measurement, replay, analysis."""
