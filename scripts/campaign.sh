#!/usr/bin/env bash
# Drive many short runs with a fault each, drawn by seed, and look at what comes of them; --help lists the options.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
[[ "${1:-}" == --help ]] || "$EV_STACK_ROOT/scripts/compile.sh" # what is compiled meanwhile would be taken for slow
export PYTHONPATH="$EV_STACK_ROOT/tools${PYTHONPATH:+:$PYTHONPATH}"
# Small disks are mounted where nobody else sees them, and are gone with us; where that is not granted, these are skipped.
# Shared memory is that of these runs alone: what other programs leave behind there is not their fault.
own_mounts=(unshare --mount --propagation private sh -c 'mount -t tmpfs none /dev/shm && exec "$0" "$@"')
if "${own_mounts[@]}" true 2>/dev/null; then
    export EV_CAMPAIGN_OWN_MOUNTS=1
    exec "${own_mounts[@]}" python -m campaign "$@"
fi
exec python -m campaign "$@"
