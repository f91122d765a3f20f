#!/usr/bin/env bash
# Drive every scenario many times in all ways, on machines of all kinds as far as one can act them; --help lists the options.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
[[ "${1:-}" == --help ]] || "$EV_STACK_ROOT/scripts/compile.sh" # what is compiled meanwhile would be taken for slow
PYTHONPATH="$EV_STACK_ROOT/tools${PYTHONPATH:+:$PYTHONPATH}" exec python -m determinism "$@"
