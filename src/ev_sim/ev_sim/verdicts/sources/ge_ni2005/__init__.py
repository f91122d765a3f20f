"""How the ids of config/published/ge_ni2005.csv are judged."""

from ev_sim.verdicts.sources.ge_ni2005 import claims, figures, law, steady

DECLARATIONS = (*steady.DECLARATIONS, *claims.DECLARATIONS, *law.DECLARATIONS, *figures.DECLARATIONS)
