"""The car held against measurement: records, open-loop replays of them, and parameters found from them."""
