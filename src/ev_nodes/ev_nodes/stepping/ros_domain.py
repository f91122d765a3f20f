"""The ROS domain that the environment names."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ev_msgs_py.refusal import ParameterError, shown

VARIABLE = "ROS_DOMAIN_ID"
_LAST = 232  # above it the numbers of its UDP ports leave 16 bits


def given_domain(environment: Mapping[str, str]) -> int | None:
    """The domain of ROS_DOMAIN_ID, None without it; ParameterError if it is not a domain.

    ROS would go on in domain 0 for -1, and in domain 1 for 1.5.
    """
    given = environment.get(VARIABLE, "")
    if not given:
        return None
    if not re.fullmatch("[0-9]{1,4}", given) or int(given) > _LAST:
        raise ParameterError(
            f"{VARIABLE}={shown(given)} is refused, expected a whole number from 0 to {_LAST}"
        )
    return int(given)
