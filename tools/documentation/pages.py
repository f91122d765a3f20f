"""Which page has which generated parts, and which of them only the built page has.

How it works: a part that somebody needs while reading the repository, or that only a run gives, is
kept in the page between its marks. All others, most of the words, follow from the code or from the
numbers in docs/measured: the repository has a mark in their place, and building the pages fills it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from documentation import (
    architecture,
    benchmark_board,
    can_reference,
    comparisons,
    full_board_tables,
    metric_reference,
    parameter_reference,
    topic_reference,
    verdict_tables,
)
from documentation.graph_diagram import graph_diagram
from documentation.hashes import HASHES
from documentation.lists import method_table, scenario_table, study_list
from documentation.markdown import block_names, built, built_names, with_blocks
from documentation.scenario_results import (
    LONG_TABLES,
    SCENARIO_PAGES,
    STUDY_PAGES,
    STUDY_TABLES,
    engine_sweep_table,
    kept_study_table,
)
from ev_study.verdicts.sources import sources

SHCHUR = "docs/shchur2019.md"
CONTROL_PERIODS = "control periods"
RESULTS = "results"  # made from runs, and so only on demand

PARTS: dict[str, Callable[[], str]] = {
    "graph": graph_diagram,
    "scenarios": scenario_table,
    "studies": study_list,
    "methods": method_table,
    "topics": topic_reference.topic_table,
    "wheel names": topic_reference.wheel_names,
    "fields": topic_reference.field_tables,
    "metrics of any run": metric_reference.metrics_of_any_run,
    "series": metric_reference.series_of_expressions,
    "functions": metric_reference.functions_of_expressions,
    "can frames": can_reference.frame_table,
    "packages": architecture.package_table,
    "rooms": architecture.room_tables,
    "comparisons": comparisons.comparison_table,
    full_board_tables.SCORES: full_board_tables.scores,
}

BUILT: dict[str, dict[str, Callable[[], str]]] = {  # page -> parts that it has where it is built
    "docs/parameters.md": {
        "common parameters": parameter_reference.common_parameters,
        "vehicle parameters": parameter_reference.vehicle_parameters,
        "master parameters": parameter_reference.master_parameters,
        "recorder parameters": parameter_reference.recorder_parameters,
        "scenario parameters": parameter_reference.scenario_parameters,
        "sensor parameters": parameter_reference.sensor_parameters,
        "method parameters": parameter_reference.method_parameters,
    },
    "docs/metrics.md": {"metrics of reports": metric_reference.metrics_of_reports},
    "docs/can.md": {
        "can signals": can_reference.signal_table,
        "can faults": can_reference.fault_table,
        "can gateway": parameter_reference.gateway_parameters,
        "can inverter": parameter_reference.inverter_parameters,
    },
    "docs/zhileykin2018.md": {"engine sweep": engine_sweep_table},
    verdict_tables.PAGE: {
        f"verdicts of {source}": partial(verdict_tables.source_table, source)
        for source in sources()
    },
    full_board_tables.PAGE: full_board_tables.BUILT,
    **{
        page: {study: partial(kept_study_table, study) for study in studies}
        for page, studies in LONG_TABLES.items()
    },
}

README = "README.md"
PAGES: dict[str, tuple[str, ...]] = {
    "docs/parameters.md": (),
    "docs/methods.md": ("scenarios", "studies", "methods"),
    "docs/topics.md": ("graph", "topics", "wheel names", "fields"),
    "docs/metrics.md": ("metrics of any run", "series", "functions"),
    "docs/can.md": ("can frames",),
    "docs/measured.md": ("comparisons",),
    "docs/architecture.md": ("packages", "rooms"),
    HASHES: (RESULTS,),
    SHCHUR: (RESULTS, CONTROL_PERIODS),
    verdict_tables.PAGE: (verdict_tables.COUNTS,),
    benchmark_board.PAGE: benchmark_board.PARTS,  # made from runs, too
    full_board_tables.PAGE: (full_board_tables.SCORES,),
    **{name: (RESULTS, *page.studies, *page.tables) for name, page in SCENARIO_PAGES.items()},
    **{
        name: tuple(
            each
            for each in (*studies, *STUDY_TABLES.get(name, {}))
            if each not in LONG_TABLES.get(name, ())
        )
        for name, studies in STUDY_PAGES.items()
    },
}


def whole_page(name: str, text: str) -> str:
    """A page with all parts that only the built page has."""
    return built(text, {part: make() for part, make in BUILT.get(name, {}).items()})


def stale_pages(root: Path) -> dict[Path, str]:
    """The pages whose generated parts are not what the code says now, with their new text.

    ValueError if a page lacks one of its parts.
    """
    stale = {}
    for name, parts in PAGES.items():
        page = root / name
        text = page.read_text(encoding="utf-8")
        if sorted(block_names(text)) != sorted(parts):
            raise ValueError(
                f"{name} has the generated parts {block_names(text)}, expected {list(parts)}"
            )
        if sorted(built_names(text)) != sorted(BUILT.get(name, ())):
            raise ValueError(
                f"{name} has marks of {built_names(text)}, expected {list(BUILT.get(name, ()))}"
            )
        new = with_blocks(text, {part: PARTS[part]() for part in parts if part in PARTS})
        if new != text:
            stale[page] = new
    return stale
