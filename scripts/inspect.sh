#!/usr/bin/env bash
# Show the running graph, its topics and their rates without the ros2 command; --help lists the options.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
exec "$EV_STACK_ROOT/scripts/ev-stack" inspect "$@"
