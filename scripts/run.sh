#!/usr/bin/env bash
# Run a scenario: scripts/run.sh SCENARIO [options]; scripts/run.sh --help lists the options.
set -euo pipefail
trap 'echo stopped >&2; exit 130' INT TERM
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
# Until the program can say that it was stopped, what would stop it has to wait.
waiting=(env --block-signal=INT --block-signal=TERM)
"${waiting[@]}" true 2>/dev/null || waiting=()
exec "${waiting[@]}" "$EV_STACK_ROOT/install/ev_sim/lib/ev_sim/ev-stack" run "$@"
