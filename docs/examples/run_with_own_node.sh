#!/usr/bin/env bash
# Drive a run over DDS with a node of your own in the place of a built-in one.
#
#     docs/examples/run_with_own_node.sh PARAMETERS OUT NODE COMMAND...
#
# PARAMETERS is the parameters.yaml that a run of scripts/run.sh has left behind, OUT a new folder for signals.npz and
# the bag, NODE the one whose place is taken, COMMAND what starts yours. ROS_DOMAIN_ID is 77 unless you say otherwise.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/setup.sh"
parameters="$1" out="$2" own="$3"
shift 3
export ROS_DOMAIN_ID="${ROS_DOMAIN_ID:-77}"

declare -A process
trap 'kill "${process[@]}" 2>/dev/null || true; wait' EXIT

# start NODE COMMAND...: start a node with the parameters and the namespace of the run.
start() {
    local node="$1" more=()
    shift
    if [[ "$node" == recorder ]]; then more=(-p "directory:=$out"); fi
    "$@" --ros-args --params-file "$parameters" -r __ns:=/ev "${more[@]}" &
    process[$node]=$!
}

for place in ev_sim/{plant,steering_column,driver,recorder} ev_control/{electronic_differential,asr}; do
    node="${place#*/}"
    if [[ "$node" == "$own" ]]; then
        start "$node" "$@"
    else
        start "$node" "$EV_STACK_ROOT/install/${place%/*}/lib/$place"
    fi
done

# The first to end are plant and recorder, when the run is over; with any other end the run has failed.
wait -n
wait "${process[recorder]}"
echo "signals and bag: $out"
