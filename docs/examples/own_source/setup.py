"""A source of your own as a package: a law, a scenario, published numbers and their verdicts; see own_source.md."""

from setuptools import setup

setup(
    name="own_source",
    version="0.1.0",
    packages=["own_source"],
    package_data={"own_source": ["published.csv", "config/*/*.yaml"]},
    install_requires=["ev_control", "ev_study"],
    entry_points={
        # the node, and the module with its laws
        "ev_stack.methods": ["electronic_differential = own_source.law"],
        "ev_stack.config": ["own_source = own_source"],  # the package with the folder config
        # PANELS, ORDER; published.csv beside it
        "ev_stack.sources": ["own_source = own_source.source"],
        # metrics and figures of the scenario of this name
        "ev_stack.reports": ["own_source = own_source.report"],
    },
)
