#!/usr/bin/env bash
# Make .venv and build the workspace, each only where it is missing or out of date.
#
# Called by setup.sh, with the words behind scripts/run.sh if that is the command. Two calls at once wait for each other;
# a failed or interrupted call leaves nothing that a later one would take for finished. Details of each step are in
# log/prepare.log.
set -euo pipefail

root="$(readlink -f "${BASH_SOURCE[0]}")" && root="${root%/*/*}"
cd "$root"
if [[ "$root" == *[[:space:]]* ]]; then
    echo "programs cannot be started from a folder with a blank in its path: $root" >&2
    exit 1
fi
unset CDPATH # by which `cd` would lead elsewhere
unset PYTHONDONTWRITEBYTECODE # one step would compile for the next in vain
export LC_ALL=C.UTF-8 PIP_DISABLE_PIP_VERSION_CHECK=1
exec {terminal}>&2 # past the log of a step
to_run=("$@")

# A ROS 2 distribution that is sourced goes before the wheels of requirements.lock.
distribution=""
if [[ -n "${ROS_DISTRO:-}" ]] && command -v ros2 >/dev/null; then
    distribution="$ROS_DISTRO"
fi
case "$distribution" in
    foxy | galactic | humble | iron)
        echo "ROS 2 $distribution is sourced, whose Python is older than 3.11: source jazzy, kilted, lyrical or rolling, or none," \
            "then ROS 2 comes by pip (docs/installing.md)" >&2
        exit 1
        ;;
esac

# Whose wheels are installed where none is sourced.
case "${EV_STACK_ROS:-jazzy}" in
    jazzy) lock_file=requirements.lock ;;
    kilted) lock_file=requirements-kilted.lock ;;
    *)
        echo "EV_STACK_ROS=$EV_STACK_ROS is refused, expected jazzy or kilted: PyPI has no other wheels of ROS 2" \
            "(docs/installing.md)" >&2
        exit 1
        ;;
esac

environment_fingerprint() {
    { echo "$root" "$distribution" && cat requirements.txt "$lock_file"; } | sha256sum
}

build_fingerprint() {
    cat .venv/.complete scripts/{prepare.sh,link_packages.py} src/*/{package.xml,setup.py,setup.cfg} | sha256sum
}

is_environment_ready() {
    [[ -x .venv/bin/python && "$(cat .venv/.complete 2>/dev/null)" == "$(environment_fingerprint)" ]]
}

# A whole .venv for this folder, beside ROS 2 or without it: other requirements can be installed into it. Wheels of another
# ROS 2 cannot: what only the former one has would stay.
can_be_updated() {
    local beside=false
    [[ -z "$distribution" ]] || beside=true
    [[ -z "${PYTHON:-}" && -x .venv/bin/python && -f .venv/.complete ]] &&
        grep -q "^command = .* $root/\.venv\$" .venv/pyvenv.cfg &&
        grep -qx "include-system-site-packages = $beside" .venv/pyvenv.cfg &&
        { $beside || has_locked_ros; }
}

has_locked_ros() {
    local version
    version="$(sed -n 's/^ros-rclpy==\([^ ]*\).*/\1/p' "$lock_file")"
    [[ -z "$version" || -d "$(packages_folder)/ros_rclpy-$version.dist-info" ]]
}

is_build_ready() {
    [[ "$(cat install/.complete 2>/dev/null)" == "$(build_fingerprint)" ]]
}

# step WHAT COMMAND...: run a command with one line of progress; on failure show the end of its output.
step() {
    local what="$1" start="$SECONDS"
    shift
    printf '%s ... ' "$what" >&2
    if ! "$@" >log/prepare.log 2>&1; then
        printf 'failed:\n' >&2
        tail -n 20 log/prepare.log >&2
        exit 1
    fi
    printf 'done in %d s\n' $((SECONDS - start)) >&2
}

ahead=()     # processes that compile meanwhile; they ignore Ctrl-C
half_made="" # a folder that is of no use as it is

tidy_up() {
    end_ahead
    [[ -z "$half_made" ]] || rm -rf "$half_made"
}

end_ahead() {
    [[ "${#ahead[@]}" -gt 0 ]] || return 0
    kill "${ahead[@]}" 2>/dev/null || true
    wait "${ahead[@]}" 2>/dev/null || true
    ahead=()
}
trap tidy_up EXIT

check_python() {
    local python="$1"
    if ! "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 15))'; then
        echo "Python 3.11 to 3.14 is needed, $python is not: name another one, PYTHON=... $0" >&2
        exit 1
    fi
}

# `ensurepip` compiles pip, twice, which takes most of the time of a new .venv: pip is unpacked as Python brings it.
make_venv() {
    local python="$1" wheel
    wheel="$("$python" -c '
import ensurepip, pathlib, sysconfig
folder = sysconfig.get_config_var("WHEEL_PKG_DIR") or pathlib.Path(ensurepip.__file__).parent / "_bundled"
print(*pathlib.Path(folder).glob("pip-*-py3-none-any.whl"), sep="\n")')" || true
    if [[ ! -f "$wheel" ]]; then # none, or several
        "$python" -m venv .venv
        return
    fi
    "$python" -m venv --without-pip .venv && .venv/bin/python -m zipfile -e "$wheel" "$(packages_folder)" || return
    printf '#!/bin/sh\nexec "%s" -m pip "$@"\n' "$root/.venv/bin/python" >.venv/bin/pip
    chmod +x .venv/bin/pip
}

packages_folder() {
    .venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))'
}

# By pip: uv does not see what the distribution has, and would install all of it anew, setuptools of another kind as well.
install_beside_distribution() {
    sed -E 's/[[:space:]]*#.*//; s/(\[|==).*//; /^ros-/d; /^uv$/d; /^$/d' requirements.txt >.venv/missing.txt
    .venv/bin/python -c 'import numpy; print("numpy==" + numpy.__version__)' >.venv/constraints.txt
    pip_install --requirement .venv/missing.txt --constraint .venv/constraints.txt
}

# The lines of the lock for the packages that an expression of awk matches.
locked() {
    awk "/^[^ #]/ { named = $1 } named" "$lock_file"
}

# uv: the one on the PATH, else the one that the lock names, down to its hash; none where it cannot be had.
find_uv() {
    uv="$(type -P uv || true)"
    [[ -z "$uv" ]] || return 0
    locked '/^uv==/' >.venv/uv.txt
    pip_install --no-deps --require-hashes --requirement .venv/uv.txt || return 0
    uv=.venv/bin/uv
}

# Python compiles what it imports when it does; pip would compile everything, which takes as long as the rest.
pip_install() {
    .venv/bin/python -m pip install --no-compile "$@"
}

# As pip is told to by its configuration.
uv_install() (
    variables="$(.venv/bin/python scripts/uv_as_pip.py <.venv/pip.txt)" || return
    eval "$variables"
    "$uv" pip install --python .venv/bin/python "$@"
)

# Exactly the files that the lock names, down to their hashes; it has all that is needed (scripts/lock-overrides.txt).
# What compiling needs comes first: a core is idle while the rest is fetched.
install_locked() {
    locked '!/^uv==/' >.venv/locked.txt
    locked '/^(llvmlite|numba|numpy|pyyaml|ros-.*|tqdm|typing-extensions)==/' >.venv/first.txt
    local words=(--no-deps --require-hashes --requirement) trouble="cannot be had"
    .venv/bin/python -m pip config list >.venv/pip.txt &
    find_uv
    if wait $! && [[ -n "$uv" ]]; then
        uv_install "${words[@]}" .venv/first.txt && compile_ahead code "${to_run[@]}" &&
            uv_install "${words[@]}" .venv/locked.txt && return
        end_ahead
        trouble="fails"
    fi
    printf 'uv %s: pip installs, which takes longer ... ' "$trouble" >&"$terminal"
    pip_install "${words[@]}" .venv/locked.txt
}

update_environment() {
    rm -f .venv/.complete # whoever interrupts this gets a new .venv
    if [[ -n "$distribution" ]]; then
        step "updating .venv" install_beside_distribution
    else
        step "updating .venv" install_locked
    fi
    environment_fingerprint >.venv/.complete
}

make_environment() {
    local python="${PYTHON:-python3}"
    rm -rf .venv
    half_made="$root/.venv"
    if [[ -n "$distribution" ]]; then
        check_python "$python"
        step "making .venv beside ROS 2 $distribution" "$python" -m venv --system-site-packages .venv
        step "installing what $distribution lacks (once)" install_beside_distribution
    else
        check_python "$python"
        step "making .venv" make_venv "$python"
        step "installing ROS 2 and the tools of $lock_file (once)" install_locked
    fi
    environment_fingerprint >.venv/.complete
    half_made=""
}

# What install/local_setup.bash works out anew, in half a tenth of a second, each time that it is sourced.
record_environment() {
    # shellcheck disable=SC2016
    env -u AMENT_PREFIX_PATH -u COLCON_PREFIX_PATH -u PYTHONPATH bash -c '
        source install/local_setup.bash
        for name in AMENT_PREFIX_PATH COLCON_PREFIX_PATH PYTHONPATH; do
            printf "export %s=%q\${%s:+:\$%s}\n" "$name" "${!name}" "$name" "$name"
        done
    ' >install/environment.bash
}

# The Python of .venv finds the packages by itself, as a kernel of Jupyter has to. Python reads a .pth file in the
# encoding of the locale, so the paths are written in ASCII, as a list that Python evaluates.
record_paths() {
    local packages=(src/*)
    .venv/bin/python -c '
import sys
print("import sys; sys.path +=", ascii(sys.argv[1:]))' \
        "${packages[@]/#src/$root/build}" >"$(packages_folder)/ev_stack.pth"
}

compile_ahead() {
    local sources
    sources="$(printf '%s:' "$root"/src/*)"
    PYTHONPATH="${sources%:}${PYTHONPATH:+:$PYTHONPATH}" .venv/bin/python scripts/compile_ahead.py "$@" >>log/compile_ahead.log 2>&1 {lock}<&- &
    ahead+=($!)
}

# colcon builds for the `ros2` of a distribution, which finds only what is built so, one package after the other.
# Elsewhere the packages are linked, which takes no time. What runs need is compiled meanwhile.
build() {
    [[ "${#ahead[@]}" -gt 0 ]] || compile_ahead code "${to_run[@]}"
    if [[ -z "$distribution" ]]; then
        .venv/bin/python scripts/link_packages.py && compile_ahead imports
        return
    fi
    compile_ahead imports
    ! compgen -G 'install/*/python' >/dev/null || rm -rf install # of link_packages.py
    .venv/bin/python -m colcon build --symlink-install --base-paths src && record_environment && record_paths
}

# Code takes longest; what cannot be compiled says so when it is used.
wait_for_ahead() {
    local counted="" shown=""
    while [[ -n "$(jobs -rp)" ]]; do
        counted="$(grep -o 'compiling (once) [0-9]* of [0-9]*' log/compile_ahead.log | tail -n 1)" || true
        [[ "$counted" == "$shown" ]] || printf '\r%s ' "$counted" >&2
        shown="$counted"
        sleep 0.1
    done
    [[ -z "$shown" ]] || echo >&2
    ahead=()
}

build_workspace() {
    rm -f install/.complete
    step "building the workspace" build
    wait_for_ahead
    ln -sf "$root/scripts/ev-stack" .venv/bin/ev-stack
    build_fingerprint >install/.complete
}

# A .venv that is there keeps its Python.
if [[ -n "${PYTHON:-}" ]] && is_environment_ready; then
    of='import platform, sys; print(platform.python_version(), "of", sys.base_prefix)'
    its="$(.venv/bin/python -c "$of")"
    if [[ "$("$PYTHON" -c "$of" 2>&1)" != "$its" ]]; then
        echo "PYTHON=$PYTHON is refused: .venv has Python $its; remove .venv, or leave PYTHON out" >&2
        exit 1
    fi
fi
if is_environment_ready && is_build_ready; then
    exit 0
fi
if [[ -e .venv && ! -O .venv ]]; then # what another user has made is neither repaired nor removed
    echo "$root/.venv belongs to $(stat -c %U .venv) and is not ready for $(id -un): let $(stat -c %U .venv) run" \
        "scripts/setup.sh, or work in a copy of your own" >&2
    exit 1
fi

exec {lock}<"$root/scripts"
flock --nonblock "$lock" || { echo "waiting for another set-up to finish ..." >&2 && flock "$lock"; }
mkdir -p log
rm -f log/compile_ahead.log
if ! is_environment_ready; then
    if can_be_updated; then
        update_environment
    else
        make_environment
    fi
fi
is_build_ready || build_workspace
