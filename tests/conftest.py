"""Settings that all tests share."""

from hypothesis import settings

# How long an example takes says nothing about our code. Where fifty examples do not suffice, the test says so.
settings.register_profile("ours", deadline=None, max_examples=30)
settings.load_profile("ours")
