"""The master of time: it publishes the state of each instant, waits for all answers, and integrates."""
