"""All declarations of all sources, and the verdicts on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache

from ev_sim.measures.metric import Metric
from ev_sim.verdicts.declaration import Declaration, by_id
from ev_sim.verdicts.need import Driven, Need, ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.sources import published, source_named, sources
from ev_sim.verdicts.verdict import Verdict, verdict


@cache
def declarations(source: str) -> Mapping[str, Declaration]:
    """How each id of a source is judged, in the order of its list of published things."""
    found = by_id(source, source_named(source).DECLARATIONS)
    return {id: found[id] for id in published(source) if id in found}


def undeclared(source: str) -> list[str]:
    """Published ids of a source that nothing judges yet."""
    return [id for id in published(source) if id not in declarations(source)]


def wanted(only: Sequence[str], quick: bool) -> list[tuple[str, Declaration]]:
    """The declarations, with their source, of some sources or ids (all if none is named); `quick`: no slow needs."""
    return [
        (source, declaration)
        for source in sources()
        for id, declaration in declarations(source).items()
        if not only or any(word in (source, id) or id.startswith(f"{word}.") for word in only)
        if not (quick and any(need.slow for need in declaration.needs))
    ]


def needs_of(chosen: Sequence[tuple[str, Declaration]]) -> list[Need]:
    """Everything that has to be driven for them, each once."""
    return list(dict.fromkeys(need for _, declaration in chosen for need in declaration.needs))


def verdicts(chosen: Sequence[tuple[str, Declaration]], driven: Mapping[Need, Driven]) -> list[Verdict]:
    """The verdicts on some ids."""
    return [verdict(published(source)[each.id], each, [driven[need] for need in each.needs]) for source, each in chosen]


def metrics_at_hand(
    source: str, scenario: str, driven: ScenarioRuns, where: Callable[[Declaration], bool] = lambda each: True
) -> dict[str, Metric]:
    """The numbers of all ids that are judged on this scenario as its file has it, for the report on any of its runs.

    A metric bears the name of its id, or ID.CHECK for the further numbers of an id.
    """
    found: dict[str, Metric] = {}
    for id, declaration in declarations(source).items():
        needs = declaration.needs
        if needs and where(declaration) and all(_is_plain(need, scenario) for need in needs):
            for name, metric in declaration.metrics(published(source)[id], [driven] * len(needs)).items():
                found[f"{id}.{name.replace(' ', '_')}" if name else id] = metric
    return found


def _is_plain(need: Need, scenario: str) -> bool:
    return isinstance(need, ScenarioNeed) and need.scenario == scenario and not (need.values or need.duration)
