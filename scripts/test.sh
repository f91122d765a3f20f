#!/usr/bin/env bash
# Set up and run the test suite, on all cores unless files or folders are named.
#
#     scripts/test.sh                    all tests; of those with many long cases three
#     scripts/test.sh --all-cases        every case as well, which takes about twice as long
#     scripts/test.sh -m "not slow"      the quick ones: no processes, no studies, no long runs
#     scripts/test.sh -k lockstep -x     any options of pytest; paths count from the top of the repository
#     scripts/test.sh --cov              with coverage
set -euo pipefail

if [[ "${1:-}" == "--help" ]]; then
    sed -n '2,/^set /s/^# \{0,1\}//p' "$0"
    exit 0
fi

# shellcheck source=scripts/setup.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/setup.sh"
cd "$EV_STACK_ROOT"
# Two processes more than there are cores: many tests wait for other processes, or for time.
cores="$(env -u OMP_NUM_THREADS nproc)" # setup.sh has said one thread, which is all that nproc would count
on_all_cores=(--numprocesses "$((cores + 2))" --dist worksteal)
for word in "$@"; do
    if [[ -e "${word%%::*}" ]]; then
        on_all_cores=() # a few tests have ended before more processes have started
    fi
done
if [[ "${#on_all_cores[@]}" -gt 0 ]]; then
    scripts/compile.sh # once, and not by the tests side by side
fi
exec python -m pytest "${on_all_cores[@]}" "$@"
