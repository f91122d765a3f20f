"""Hold the methods of own_method.py and own_law.py against the contract; in a test it is the same."""

import own_law
import own_method

from ev_msgs_py.check.method import check_method

for module, name in ((own_method, "limit"), (own_law, "limit_in_python"), (own_law, "limit_compiled")):
    check_method("asr", name)
    check_method("asr", name, {"limit": 150.0, "vehicle.driven_wheels": ["rear_left", "rear_right"]})
    print(f"{name} of {module.__name__} keeps the contract")
