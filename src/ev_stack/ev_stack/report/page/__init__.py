"""report.html: everything that a run, a study or a comparison gave on one page that needs nothing but a browser.

`plot_groups` knows what is plotted together, `parameter_units` in what units parameters are,
`writing` packs the signals and fills the templates.
"""
