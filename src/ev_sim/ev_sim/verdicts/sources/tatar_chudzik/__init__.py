"""How the ids of config/published/tatar_chudzik.csv are judged."""

from ev_sim.verdicts.sources.tatar_chudzik import claims, figures, sums

DECLARATIONS = (*figures.DECLARATIONS, *claims.DECLARATIONS, *sums.DECLARATIONS)
