"""A local page that shows a running graph and changes its parameters.

`live_frames` hears the topics, `controls` calls services of parameters and time, `server` carries both to pages of a
browser, and `attached` says which graph it is and when it has ended.
"""
