#!/usr/bin/env bash
# The long form of the fuzz tests: scripts/fuzz.sh [CASES [SEED]], default 100000 cases with seed 1, shared among all decoders.
set -euo pipefail
if [[ "${1:-}" == "--help" ]]; then
    sed -n '2p' "$0" | cut -c3-
    exit 0
fi
export EV_FUZZ_CASES="${1:-100000}"
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/test.sh" tests/fuzz --numprocesses auto --dist worksteal --timeout 0 --hypothesis-show-statistics --hypothesis-seed "${2:-1}"
