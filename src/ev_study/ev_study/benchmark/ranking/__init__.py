"""Results of a board: costs, scores with intervals, ranks, tables, pages, figure and files."""
