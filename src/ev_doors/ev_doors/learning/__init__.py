"""Gymnasium environments; importing it registers their ids (docs/embedding.md)."""

from ev_stack.interface import extra

IDS = {  # -> arguments of Environment
    "ev_sim/TorqueSplit-v0": {"scenario": "double_lane_change", "action": "torque_split"},
    "ev_sim/TractionControl-v0": {
        "scenario": "launch_split_mu", "run": "fixed_steering", "action": "traction_control"
    },
    "ev_sim/Steering-v0": {"scenario": "double_lane_change", "action": "steering"},
}  # fmt: skip

_register = extra("gymnasium", "ev_doors[gymnasium]").register
for _id, _arguments in IDS.items():
    _register(_id, "ev_doors.learning.environment:Environment", kwargs=_arguments)
