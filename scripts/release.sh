#!/usr/bin/env bash
# Give what is unreleased a version: scripts/release.sh 0.2.0. It writes files only; docs/installing.md says what follows.
set -euo pipefail
root="$(readlink -f "${BASH_SOURCE[0]}")" && root="${root%/*/*}"
if [[ $# -ne 1 || "$1" == --help ]]; then
    sed -n '2s/^# //p' "$0"
    exit 2
fi
exec "${PYTHON:-python3}" "$root/tools/release.py" "$root" "$1"
