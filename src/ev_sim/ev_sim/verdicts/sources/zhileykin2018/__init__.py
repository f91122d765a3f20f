"""How the ids of config/published/zhileykin2018.csv are judged."""

from ev_sim.verdicts.sources.zhileykin2018 import equations, inputs, runs

DECLARATIONS = (*inputs.DECLARATIONS, *runs.DECLARATIONS, *equations.DECLARATIONS)
