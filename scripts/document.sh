#!/usr/bin/env bash
# Write the generated parts of docs/ anew, and all pages whole to build/pages; --runs also drives, --check only looks.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
PYTHONPATH="$EV_STACK_ROOT/tools${PYTHONPATH:+:$PYTHONPATH}" exec python -m documentation "$EV_STACK_ROOT" "$@"
