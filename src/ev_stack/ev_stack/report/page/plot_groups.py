"""Channels that are plotted together on a page."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ev_msgs_py.contract.topics import TOPICS, Topic

NO_TOPIC = "measured"  # title of the group of what stands in no topic


def groups_of(
    channels: Iterable[str], units: Mapping[str, str] | None = None
) -> list[dict[str, Any]]:
    """Topics with their fields and these with their curves, in the order of the table of topics.

    What stands in no topic makes groups by the first part of its name if there is one, with its
    unit by name in `units` and without meaning.
    """
    names = set(channels)
    known = [group for topic in TOPICS.values() if (group := _of_topic(topic, names))["plots"]]
    listed = {
        curve["channel"] for group in known for plot in group["plots"] for curve in plot["curves"]
    }
    others: dict[str, list[str]] = {}
    for name in sorted(names - listed):
        first, dot, _ = name.partition(".")
        others.setdefault(first if dot else NO_TOPIC, []).append(name)
    return [*known, *(_unknown(first, members, units or {}) for first, members in others.items())]


def _of_topic(topic: Topic, names: set[str]) -> dict[str, Any]:
    plots = []
    prefix = topic.name.replace("/", ".")
    for field, declared in topic.shape.fields.items():
        start = f"{prefix}.{field}"
        found = [
            channel for channel in topic.channels if channel in names and _belongs(channel, start)
        ]
        if found:
            curves = [_curve(channel, start) for channel in found]
            plots.append(
                {
                    "title": words(field),
                    "unit": declared.unit,
                    "about": declared.about,
                    "curves": curves,
                }
            )
    about = (topic.signal.__doc__ or "").partition("\n")[0]
    return {"title": topic.name, "about": about, "plots": plots}


def _unknown(first: str, members: Sequence[str], units: Mapping[str, str]) -> dict[str, Any]:
    plots = [
        {
            "title": words(name.partition(".")[2] or name),
            "unit": units.get(name, ""),
            "about": "",
            "curves": [_curve(name, name)],
        }
        for name in members
    ]
    return {"title": first, "about": "", "plots": plots}


def _belongs(channel: str, start: str) -> bool:
    # With the dot: `angle` must not take in `angle_rate`.
    return channel == start or channel.startswith(start + ".")


def _curve(channel: str, start: str) -> dict[str, str]:
    return {"channel": channel, "label": words(channel.removeprefix(start).removeprefix("."))}


def words(name: str) -> str:
    """A name in words."""
    return name.replace("_", " ").replace(".", " ")
