"""Which node may publish what: what each node needs, as DDS security policies and held against the running graph."""
