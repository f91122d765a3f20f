"""Pictures of the live page and of a report, as a browser shows them."""
