"""Which page has which generated parts."""

from __future__ import annotations

from collections.abc import Callable
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
from documentation.markdown import block_names, with_blocks
from documentation.scenario_results import SCENARIO_PAGES, STUDY_PAGES, STUDY_TABLES

SHCHUR = "docs/shchur2019.md"
CONTROL_PERIODS = "control periods"
RESULTS = "results"  # made from runs, and so only on demand

PARTS: dict[str, Callable[[], str]] = {
    "graph": graph_diagram,
    "scenarios": scenario_table,
    "studies": study_list,
    "methods": method_table,
    "common parameters": parameter_reference.common_parameters,
    "vehicle parameters": parameter_reference.vehicle_parameters,
    "master parameters": parameter_reference.master_parameters,
    "recorder parameters": parameter_reference.recorder_parameters,
    "scenario parameters": parameter_reference.scenario_parameters,
    "sensor parameters": parameter_reference.sensor_parameters,
    "method parameters": parameter_reference.method_parameters,
    "topics": topic_reference.topic_table,
    "wheel names": topic_reference.wheel_names,
    "fields": topic_reference.field_tables,
    "metrics of any run": metric_reference.metrics_of_any_run,
    "functions": metric_reference.functions_of_expressions,
    "series": metric_reference.series_of_expressions,
    "metrics of reports": metric_reference.metrics_of_reports,
    "can frames": can_reference.frame_table,
    "can signals": can_reference.signal_table,
    "can faults": can_reference.fault_table,
    "can gateway": parameter_reference.gateway_parameters,
    "can inverter": parameter_reference.inverter_parameters,
    "packages": architecture.package_table,
    "rooms": architecture.room_tables,
    "comparisons": comparisons.comparison_table,
    **full_board_tables.PARTS,
}

README = "README.md"
PAGES = {
    "docs/methods.md": ("scenarios", "studies", "methods"),
    "docs/parameters.md": tuple(name for name in PARTS if name.endswith("parameters")),
    "docs/topics.md": ("graph", "topics", "wheel names", "fields"),
    "docs/metrics.md": ("metrics of any run", "series", "functions", "metrics of reports"),
    "docs/can.md": tuple(name for name in PARTS if name.startswith("can ")),
    "docs/measured.md": ("comparisons",),
    "docs/architecture.md": ("packages", "rooms"),
    HASHES: (RESULTS,),
    SHCHUR: (RESULTS, CONTROL_PERIODS),
    verdict_tables.PAGE: verdict_tables.PARTS,  # made from runs, too
    benchmark_board.PAGE: benchmark_board.PARTS,  # the same
    benchmark_board.LAWS_PAGE: (benchmark_board.LAW_PAGES,),
    full_board_tables.PAGE: tuple(full_board_tables.PARTS),
    **{name: (RESULTS, *page.studies, *page.tables) for name, page in SCENARIO_PAGES.items()},
    **{name: (*studies, *STUDY_TABLES.get(name, {})) for name, studies in STUDY_PAGES.items()},
}


def stale_pages(root: Path) -> dict[Path, str]:
    """The pages whose generated parts are not what the code says now, with their new text.

    ValueError if a page lacks one of its parts.
    """
    stale = {}
    for name, parts in PAGES.items():
        page = root / name
        text = page.read_text(encoding="utf-8")
        if sorted(block_names(text)) != sorted(parts):
            raise ValueError(f"{name} has the generated parts {block_names(text)}, it should have {list(parts)}")
        new = with_blocks(text, {part: PARTS[part]() for part in parts if part in PARTS})
        if new != text:
            stale[page] = new
    return stale
