"""report.html: everything that a run, a study or a comparison gave on one page that needs nothing but a browser.

`codec` packs signals, `quantities` says what is plotted together, `top_view` what the moving car needs, `content`
puts the parts together, and `writing` fills the templates with them.
"""
