"""How an id is judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ev_sim.measures.metric import Metric
from ev_sim.verdicts.check import Basis, Check
from ev_sim.verdicts.need import Need
from ev_sim.verdicts.sources import Published, published

Assumption = str | Callable[..., str]


@dataclass(frozen=True, slots=True)
class Declaration:
    """How one id is judged: what has to be driven, and which numbers of it are held against what.

    `needs`: what is driven, none for what follows from equations alone; each check gets one argument for each need.
    `assumption`: what had to be added to the source, empty if nothing; a function of what was driven if it depends on
    that. `inputs`: why the number cannot fail by physics, because it comes from the inputs of the run. `unjudged`: why
    there is no verdict, in full ("not judgeable: ...", "no verdict: ..."); numbers beside it are shown, not judged.
    """

    id: str
    needs: tuple[Need, ...] = ()
    checks: tuple[Check, ...] = ()
    assumption: Assumption = ""
    inputs: str = ""
    unjudged: str = ""

    def metrics(self, of: Published, driven: Sequence[Any]) -> dict[str, Metric]:
        """The numbers of this id by name of the check; `driven` are the results of the needs, in their order."""
        given = tuple(driven)
        assumption = self.assumption(*given) if callable(self.assumption) else self.assumption
        basis = Basis(of, assumption, self.inputs)
        metrics = {check.name: check.metric(basis, given) for check in self.checks}
        if self.unjudged:
            return {name: replace(metric, reference=None) for name, metric in metrics.items()}
        return metrics


def judged(
    id: str, needs: Need | tuple[Need, ...], *checks: Check, assumption: Assumption = "", inputs: str = ""
) -> Declaration:
    """An id with a verdict."""
    return Declaration(id, needs if isinstance(needs, tuple) else (needs,), checks, assumption, inputs)


def not_judgeable(id: str, why: str, needs: tuple[Need, ...] = (), *checks: Check) -> Declaration:
    """An id of which too little is left in the source; numbers may be shown all the same."""
    return Declaration(id, needs, checks, unjudged=f"not judgeable: {why}")


def no_verdict(id: str, why: str, needs: tuple[Need, ...] = (), *checks: Check) -> Declaration:
    """An id that is no claim about numbers, such as a scheme, or a number that the source announces only."""
    return Declaration(id, needs, checks, unjudged=f"no verdict: {why}")


def by_id(source: str, declarations: Sequence[Declaration]) -> Mapping[str, Declaration]:
    """The declarations of a source by id; ValueError for an id that its list lacks, and for one declared twice."""
    found: dict[str, Declaration] = {}
    for declaration in declarations:
        if declaration.id not in published(source):
            raise ValueError(f"{declaration.id} is not in the list of what {source} published")
        if declaration.id in found:
            raise ValueError(f"{declaration.id} is declared twice")
        found[declaration.id] = declaration
    return found
