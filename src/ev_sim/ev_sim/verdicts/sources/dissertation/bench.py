"""Chapter 4 of the dissertation: the test bench, which is not there yet."""

from __future__ import annotations

from ev_sim.verdicts.declaration import Declaration, not_judgeable

_NEEDS_THE_BENCH = "not judgeable yet: needs the test bench"

DECLARATIONS: tuple[Declaration, ...] = (
    *(
        Declaration(id, unjudged=_NEEDS_THE_BENCH)
        for id in (
            "diss.bench.sequence",
            "diss.bench.channels",
            "diss.bench.T1_T9",
            "diss.bench.exchange",
            "diss.bench.spin",
            "diss.bench.agreement",
            "diss.fig5.26",
        )
    ),
    not_judgeable("diss.bench.timing", "neither sample time, model step, rate of the bus nor latency is printed"),
)
