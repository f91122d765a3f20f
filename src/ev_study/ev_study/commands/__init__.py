"""Commands of `ev-stack run` over many runs, by name."""

COMMANDS: dict[str, tuple[str, str]] = {}

STUDY = "ev_study.studies.run_study:run_study"

REVIEWS = {  # name -> module and function that takes words, and what it does
    "verdicts": (
        "ev_study.commands.verdicts:run_verdicts",
        "a verdict on every number, curve and claim of all sources, in one table",
    ),
    "replay": (
        "ev_study.commands.replay:run_replay",
        "recorded inputs into a law or a node, and where its answers differ from the recorded ones",
    ),
    "figures": (
        "ev_study.commands.verdicts:run_figures",
        "every panel of the sources' figures, drawn from our runs, on one page",
    ),
    "validate": (
        "ev_study.commands.measured:run_validate",
        "a car against a record of a real one: inputs imposed as measured, the rest compared",
    ),
    "identify": (
        "ev_study.commands.measured:run_identify",
        "parameters of a car from a record of it, or a tyre from a rig, with intervals",
    ),
    "benchmark": (
        "ev_study.commands.benchmark:run_benchmark",
        "laws of torque control ranked on a board of cars, roads and manoeuvres, with intervals",
    ),
    "tune": (
        "ev_study.commands.tune:run_tune",
        "the parameters of a law by CMA-ES on a board, with the same budget for every law",
    ),
}
