#!/usr/bin/env bash
# Set up the workspace on first use and enter its environment.
#
#     source scripts/setup.sh    then python, colcon and ros2 (if there is one) know the workspace
#     scripts/setup.sh           only set up
#
# All other scripts begin with this one; when everything is up to date it takes less than 0.1 s.
# PYTHON=... names the Python that .venv is made with.

if [[ "${BASH_SOURCE[0]}" == "$0" ]]; then
    if [[ $# -gt 0 ]]; then
        sed -n '2,/^$/s/^# \{0,1\}//p' "$0"
        [[ "$1" == "--help" ]]
        exit
    fi
    exec "$(dirname "$(readlink -f "$0")")/prepare.sh"
fi

# Through links, and without `cd`, which CDPATH leads elsewhere.
EV_STACK_ROOT="$(readlink -f "${BASH_SOURCE[0]}")" && EV_STACK_ROOT="${EV_STACK_ROOT%/*/*}"

# The ROS 2 wheels start Python anew with their libraries on LD_LIBRARY_PATH and mark that by a variable:
# what another environment left there must not reach ours.
if [[ -n "${_ROS_WHEELS_BOOTSTRAP_COMPLETE:-}" ]]; then
    unset _ROS_WHEELS_BOOTSTRAP_COMPLETE
    LD_LIBRARY_PATH="$(tr ':' '\n' <<<"${LD_LIBRARY_PATH:-}" | sed '/\/ros_[^/]*\.libs$/d' | paste -sd ':')"
fi

"$EV_STACK_ROOT/scripts/prepare.sh" "${ev_stack_run[@]}" || return

if [[ ":$PATH:" != *":$EV_STACK_ROOT/.venv/bin:"* ]]; then
    PATH="$EV_STACK_ROOT/.venv/bin:$PATH"
fi
if [[ ":${AMENT_PREFIX_PATH:-}:" != *":$EV_STACK_ROOT/install/ev_sim:"* ]]; then
    # shellcheck disable=SC1091
    source "$EV_STACK_ROOT/install/environment.bash"
fi

export EV_STACK_ROOT

# Discovery stays on this machine, unless the user says otherwise: by our profile where the middleware is Fast DDS 3
# (from Kilted on), else by what ROS 2 itself offers.
if [[ "${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}" == LOCALHOST && -z "${FASTDDS_DEFAULT_PROFILES_FILE:-}" ]]; then
    if [[ "${ROS_DISTRO:-kilted}" > "jazzy" && "${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}" == rmw_fastrtps* ]]; then
        export FASTDDS_DEFAULT_PROFILES_FILE="$EV_STACK_ROOT/config/fastdds.xml"
        export ROS_AUTOMATIC_DISCOVERY_RANGE=SYSTEM_DEFAULT
    else
        export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
    fi
fi

# A graph is a dozen processes: without kept bytecode each would compile all its modules anew.
unset PYTHONDONTWRITEBYTECODE

# One thread per process: faster to start, and sums are always added up in the same order.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1
