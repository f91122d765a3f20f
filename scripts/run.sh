#!/usr/bin/env bash
# Run a scenario: scripts/run.sh SCENARIO [options]; scripts/run.sh --help lists the options.
set -euo pipefail
trap 'echo stopped >&2; exit 130' INT TERM
[[ -e /proc/self/fd/2 ]] || exec 2>/dev/null
pwd -P &>/dev/null || { echo "error: the working directory was deleted, expected one that exists" >&2 && exit 1; }
here="${BASH_SOURCE[0]}"
[[ ! -L "$here" ]] || here="$(readlink -f "$here")"
[[ "$here" == */* ]] || here="./$here"
# shellcheck disable=SC2034 # set-up compiles what this run needs
ev_stack_run=("$@")
# Without another process in it: Ctrl-C would leave this command without a path, before the trap has its turn.
# shellcheck source=scripts/setup.sh
source "${here%/*}/setup.sh"
# Warnings of other packages end no run.
unset PYTHONWARNINGS
exec "$EV_STACK_ROOT/scripts/ev-stack" run "$@"
