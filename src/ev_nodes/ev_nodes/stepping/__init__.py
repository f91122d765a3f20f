"""A node that messages step: reading, writing, parameters, reports, its way to the runner, stopping."""
