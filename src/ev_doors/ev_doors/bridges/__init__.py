"""Nodes for messages of other ROS projects, where their packages exist (docs/bridges.md)."""

from ev_msgs_py.wire import message_class


def needed(kind: str) -> type:
    """Load the class of a message, service or action.

    Raises ImportError, in one line, if its package is not sourced.
    """
    try:
        return message_class(kind)
    except ImportError:
        raise ImportError(
            f"{kind} is needed, and the package {kind.partition('/')[0]} is not sourced here"
        ) from None
