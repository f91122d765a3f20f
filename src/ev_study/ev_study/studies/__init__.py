"""Studies: many runs of scenarios, driven side by side by worker processes, and one table of all.

How it works, for studies, boards and verdicts alike: cases -> rows -> table -> page. A case has a
key, a digest of all that its row depends on (kept_rows.py); rows of earlier commands come from the
store (result_store.py). For the others jobs are performed by workers of this machine or of a
cluster (workers.py, driving.py), and each row is kept as it comes. What is made of all rows is a
table (metric_table.py), metrics, figures and a page (run_study.py). The options of all this are
declared once (options.py).
"""
