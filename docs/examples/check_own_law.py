"""Hold the methods of the other examples against the contract; in a test it is the same."""

import own_law
import own_method
import yaw_feedback
import yaw_moment

from ev_core.check.method import check_method

REAR = {"vehicle.driven_wheels": ["rear_left", "rear_right"]}

for role, module, name, values in (
    ("asr", own_method, "limit", {"limit": 150.0}),
    ("asr", own_law, "limit_in_python", {"limit": 150.0}),
    ("asr", own_law, "limit_compiled", {"limit": 150.0}),
    ("electronic_differential", yaw_feedback, "yaw_feedback", {"gain": 500.0}),
    ("electronic_differential", yaw_moment, "yaw_moment", {"control": "sliding_mode"}),
):
    check_method(role, name)
    check_method(role, name, {**values, **REAR})
    print(f"{name} of {module.__name__} keeps the contract")
