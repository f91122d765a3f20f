#!/usr/bin/env bash
# Drive many short runs with a fault each, drawn by seed, and look at what comes of them; --help lists the options.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
export PYTHONPATH="$EV_STACK_ROOT/tools:$PYTHONPATH"
# Small disks are mounted where nobody else sees them, and are gone with us; where that is not granted, these are skipped.
own_mounts=(unshare --mount --propagation private)
if "${own_mounts[@]}" true 2>/dev/null; then
    export EV_CAMPAIGN_OWN_MOUNTS=1
    exec "${own_mounts[@]}" python -m campaign "$@"
fi
exec python -m campaign "$@"
