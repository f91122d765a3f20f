"""What a board has given: costs, scores with intervals, ranks, tables, pages, figure and files (docs/benchmark.md)."""
