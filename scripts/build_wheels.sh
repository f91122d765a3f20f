#!/usr/bin/env bash
# Build the wheels of all packages, for `pip install` without ROS: scripts/build_wheels.sh [DIR], by default dist.
set -euo pipefail
root="$(readlink -f "${BASH_SOURCE[0]}")" && root="${root%/*/*}"
mkdir -p "${1:-$root/dist}"
folder="$(readlink -f "${1:-$root/dist}")"
wheel=(python3 -m pip wheel)
[[ ! -x "$root/.venv/bin/python" ]] || wheel=("$root/.venv/bin/python" -m pip wheel --no-build-isolation)
copy="$(mktemp -d)"
trap 'rm -rf "$copy"' EXIT
for package in "$root"/src/*; do # of copies: a build leaves its traces beside the sources
    mkdir "$copy/${package##*/}"
    (cd "$package" && tar --dereference --exclude=__pycache__ --exclude='*.egg-info' -cf - .) | tar -xf - -C "$copy/${package##*/}"
done
"${wheel[@]}" --quiet --disable-pip-version-check --no-deps --wheel-dir "$folder" "$copy"/*
ls "$folder"/ev_*.whl
