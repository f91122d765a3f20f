#!/usr/bin/env bash
# Compile all methods beforehand, on all cores; nothing where that was done with these sources. For tests and images.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
cd "$EV_STACK_ROOT"
sources="$(find src -name __pycache__ -prune -o -name '*.py' -print | LC_ALL=C sort | xargs cat | sha256sum)"
if [[ "$(cat install/.compiled 2>/dev/null)" != "$sources" ]]; then
    ev-stack compile || true # a law that cannot be compiled says so when it is run
    echo "$sources" >install/.compiled
fi
