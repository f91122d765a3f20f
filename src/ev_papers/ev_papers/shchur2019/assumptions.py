"""What had to be added to Shchur (2019), and what his plant and driver are given."""

from __future__ import annotations

from ev_sim.verdicts.need import ScenarioRuns

FIVE_TIMES = 'gamma = 5, the reading of "amplified five times"'


SAMPLED = "column and law are sampled, the paper's are not"


SIGN_OF_RADIUS = "sign of delta in eq 11 (printed without)"


SET_ANGLE = "the driver is told these angles and has integral action"


SET_SPEED = "the driver is told these speeds and has integral action"


ACKERMANN = "the kinematic plant turns its wheels by the same eqs 8 to 12"


def five_times_and_drives(driven: ScenarioRuns) -> str:
    """The reading of the amplification, and ideal drives where these drive."""
    ideal = driven.parameters.get("plant", {}).get("drive", "ideal") == "ideal"
    return f"{FIVE_TIMES}; ideal drives" if ideal else FIVE_TIMES
