#!/usr/bin/env bash
# Set up the workspace on first use and enter its environment.
#
#     source scripts/setup.sh    then python, the shell and ros2 (if there is one) know the workspace
#     scripts/setup.sh           only set up
#
# All other scripts begin with this one; when everything is up to date it takes less than 0.1 s.
# PYTHON=... names the Python that .venv is made with, EV_STACK_ROS=kilted takes the wheels of ROS 2 Kilted in place of Jazzy's.

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
if [[ ":${AMENT_PREFIX_PATH:-}:" != *":$EV_STACK_ROOT/install/ev_stack:"* ]]; then
    # shellcheck disable=SC1091
    source "$EV_STACK_ROOT/install/environment.bash"
fi

export EV_STACK_ROOT

# Discovery stays on this machine, unless the user says otherwise: by our profile where the middleware is Fast DDS, else by what
# ROS 2 itself offers. Fast DDS 2 (Jazzy) is the package fastrtps, in .venv or in the distribution; Fast DDS 3 (from Kilted on) is
# fastdds. Each would complain about the profile of the other.
if [[ "${FASTDDS_DEFAULT_PROFILES_FILE:-}${FASTRTPS_DEFAULT_PROFILES_FILE:-}" == "$EV_STACK_ROOT"/config/fastdds*.xml ]]; then
    unset FASTDDS_DEFAULT_PROFILES_FILE FASTRTPS_DEFAULT_PROFILES_FILE # of an earlier call, perhaps for another ROS 2
    [[ "${ROS_AUTOMATIC_DISCOVERY_RANGE:-}" != SYSTEM_DEFAULT ]] || unset ROS_AUTOMATIC_DISCOVERY_RANGE
fi
if [[ "${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}" == LOCALHOST &&
    -z "${FASTDDS_DEFAULT_PROFILES_FILE:-}${FASTRTPS_DEFAULT_PROFILES_FILE:-}" ]]; then
    export ROS_AUTOMATIC_DISCOVERY_RANGE=SYSTEM_DEFAULT
    IFS=: read -ra ev_stack_prefixes <<<"${AMENT_PREFIX_PATH:-/}"
    if [[ "${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}" != rmw_fastrtps* ]]; then
        ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
    elif compgen -G "$EV_STACK_ROOT/.venv/lib/python*/site-packages/ros_fastrtps-*.dist-info" >/dev/null ||
        [[ -n "$(ls -d "${ev_stack_prefixes[@]/%//share/fastrtps}" 2>/dev/null)" ]]; then
        export FASTRTPS_DEFAULT_PROFILES_FILE="$EV_STACK_ROOT/config/fastdds2.xml"
    else
        export FASTDDS_DEFAULT_PROFILES_FILE="$EV_STACK_ROOT/config/fastdds.xml"
    fi
    unset ev_stack_prefixes
fi

# A graph is a dozen processes: without kept bytecode each would compile all its modules anew.
unset PYTHONDONTWRITEBYTECODE

# One thread per process: faster to start, and sums are always added up in the same order.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1
