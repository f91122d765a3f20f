"""report.html: everything that a run, a study or a comparison gave on one page that needs nothing but a browser.

`top_view` knows what is plotted together and what the moving car needs, `writing` packs the signals and fills the
templates.
"""
