"""The sources: what each of them published, measured, drawn and held against our runs. One folder each."""
