"""Energies of the dissertation's table 5.6, printed as kWh."""

from __future__ import annotations

from ev_sim.study import dissertation_tables as printed
from ev_sim.verdicts.check import Number, Shown
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.sources.dissertation.assumptions import BENCH, OF_METHOD, ROAD
from ev_sim.verdicts.sources.dissertation.runs import FIVE_ON_BENCH, ByMethod, mean, order, order_shown
from ev_sim.verdicts.tolerance import relative

_DRIVER = "pulse"
_ASSUMED = (
    f"{BENCH}; what is printed as kWh is kW min; it is the energy over the windows of traction, not eq 2.40 as "
    "printed, mean power of the 355.2 s of traction times the 580 s of the cycle; both circuits summed; driver "
    "pulse at k = 1.11 times the power of packed snow's limit, k fitted on method 2's wheel efficiency"
)


def _energy(method: int) -> Declaration:
    return judged(
        f"diss.t5.6.energy.m{method}",
        FIVE_ON_BENCH,
        Number(
            "kW min",
            printed.ENERGY[method],
            relative(0.05, "losses and lengths of the segments"),
            mean("energy_windows", method, _DRIVER, printed.KILOWATT_MINUTE),
        ),
        Shown("kW min", mean("energy", method, _DRIVER, printed.KILOWATT_MINUTE), "pedal pressed only"),
        Shown("kW min", mean("energy_as_printed", method, _DRIVER, printed.KILOWATT_MINUTE), "eq 2.40 as printed"),
        Shown("kW h", mean("energy_as_printed", method, _DRIVER, printed.KILOWATT_HOUR), "that is"),
        assumption=f"{_ASSUMED}; {OF_METHOD[method].replace('very number', 'method')}; {ROAD}",
    )


def _in_order(of: ByMethod) -> bool:
    return of[1] < of[4] < of[3] < of[2] < of[5]


def _first_and_second(of: ByMethod) -> bool:
    return of[1] < of[2]


DECLARATIONS: tuple[Declaration, ...] = (
    *map(_energy, printed.ENERGY),
    judged(
        "diss.t5.6.energy.order",
        FIVE_ON_BENCH,
        order("energy_windows", _DRIVER, _in_order),
        order_shown("energy_windows", _DRIVER, _first_and_second, "1 < 2 alone"),
        assumption=f"{BENCH}; driver pulse",
    ),
)
