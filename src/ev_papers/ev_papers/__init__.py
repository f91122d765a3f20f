"""The sources, one folder each: published numbers, their measures, and figures beside ours."""
