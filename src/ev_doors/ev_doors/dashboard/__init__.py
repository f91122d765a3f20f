"""A local page that shows a running graph and changes its parameters.

`live_frames` takes what the graph sends, `controls` calls services of parameters and time, and
`server` carries both to pages of a browser, until the run has ended.
"""
