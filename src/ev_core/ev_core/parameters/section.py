"""Sections of ROS parameter files: the nodes that the name of a section means."""

from __future__ import annotations

import re

ANY_NAMESPACE = "/**"


def matches(pattern: str, node: str) -> bool:
    """Return whether a section name means a node of this full name.

    `/**` stands for any namespaces, `*` for one token.
    """
    # A name without a slash is one below the root.
    expression = re.escape(pattern if pattern.startswith("/") else f"/{pattern}")
    expression = expression.replace(r"/\*\*", r"(/\w+)*").replace(r"\*", r"\w+")
    return re.fullmatch(expression, node) is not None
