#!/usr/bin/env bash
# Write requirements.lock and requirements-kilted.lock anew from requirements.txt: every package that is installed, with its
# version and hashes. Needs uv.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
command -v uv >/dev/null || { echo "uv is needed: pip install uv" >&2 && exit 1; }

# lock FILE WORDS...
lock() {
    uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-emit-find-links \
        --override scripts/lock-overrides.txt --custom-compile-command scripts/lock.sh requirements.txt --output-file "$@"
}

lock requirements.lock "$@"
lock requirements-kilted.lock --override scripts/kilted-overrides.txt "$@"
