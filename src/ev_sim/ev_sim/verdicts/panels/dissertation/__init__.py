"""The figures of the dissertation."""

from ev_sim.verdicts.panels.dissertation import bench, cycle, machine, schemes, simulation

PANELS = (*machine.PANELS, *cycle.PANELS, *simulation.PANELS, *bench.PANELS, *schemes.PANELS)
