#!/usr/bin/env bash
# Watch and change a running graph on a local page: scripts/dashboard.sh [SCENARIO]; --help lists the options.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
unset PYTHONWARNINGS # those of other packages end no run
exec "$EV_STACK_ROOT/scripts/ev-stack" dashboard "$@"
