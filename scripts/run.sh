#!/usr/bin/env bash
# Run a scenario: scripts/run.sh SCENARIO [options]; scripts/run.sh --help lists the options.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
exec "$EV_STACK_ROOT/install/ev_sim/lib/ev_sim/ev-stack" run "$@"
