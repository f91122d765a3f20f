"""Gymnasium environments; importing it registers their ids (docs/embedding.md)."""

from ev_stack.interface import extra

IDS = {  # -> arguments of Environment
    "ev_stack/TorqueSplit-v0": {"scenario": "double_lane_change", "action": "torque_split"},
    "ev_stack/TractionControl-v0": {
        "scenario": "launch_split_mu", "run": "fixed_steering", "action": "traction_control"
    },
    "ev_stack/Steering-v0": {"scenario": "double_lane_change", "action": "steering"},
}  # fmt: skip

FORMER = "ev_sim/"  # beginning of the ids up to now, which go on

_register = extra("gymnasium", "ev_doors[gymnasium]").register
for _id, _arguments in IDS.items():
    for _name in (_id, _id.replace("ev_stack/", FORMER)):
        _register(
            _name,
            "ev_doors.learning.environment:Environment",
            vector_entry_point="ev_doors.learning.vector:VectorEnvironment",
            kwargs=_arguments,
        )
