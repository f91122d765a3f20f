"""DDS security is there in full where it is asked for, or nothing starts."""

from __future__ import annotations

from collections.abc import Mapping

from ev_msgs_py.parameters.shown import quoted


def security_is_asked_for(environment: Mapping[str, str]) -> bool:
    """Whether ROS 2 shall encrypt and authenticate; it takes nothing but the word true for that."""
    return environment.get("ROS_SECURITY_ENABLE") == "true"


def refuse_weak_security(environment: Mapping[str, str]) -> None:
    """RuntimeError where security is asked for in a way in which ROS 2 would quietly do without it.

    With Enforce a node without keys, or with a middleware that was built without security, cannot be made: what it
    lacks is in the line of that error.
    """
    enabled = environment.get("ROS_SECURITY_ENABLE", "false")
    if enabled not in ("true", "false"):
        raise RuntimeError(f"ROS_SECURITY_ENABLE: {quoted(enabled)} counts as no security; allowed: true, false")
    strategy = environment.get("ROS_SECURITY_STRATEGY", "Permissive")
    if enabled == "true" and strategy != "Enforce":
        raise RuntimeError(
            f"ROS_SECURITY_STRATEGY: {quoted(strategy)} lets nodes without keys speak unprotected; allowed with "
            "ROS_SECURITY_ENABLE=true: Enforce"
        )
    if enabled == "true" and not environment.get("ROS_SECURITY_KEYSTORE"):
        raise RuntimeError("ROS_SECURITY_KEYSTORE: '' with ROS_SECURITY_ENABLE=true; allowed: the folder of the keys")
