#!/usr/bin/env bash
# Build the documentation as a site with search: build/site/index.html, and pack it: scripts/site.sh [ARCHIVE.tar.gz].
# A broken link ends it with status 1.
# The site needs no network; building it for the first time takes pip, and npm for two scripts.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
environment=build/site_environment

# script FILE PACKAGE VERSION SHA512: a file of an npm package, whose archive has this digest.
script() {
    npm pack --silent --pack-destination "$environment" "$2@$3" >/dev/null
    echo "$4  $environment/$2-$3.tgz" | sha512sum --check --quiet
    tar -xzf "$environment/$2-$3.tgz" -O "package/$1" >"$environment/$2.js"
}

is_ready() {
    [[ "$(cat "$environment/.complete" 2>/dev/null)" == "$(cat docs/requirements-site.txt scripts/site.sh)" ]]
}

if ! is_ready; then
    command -v npm >/dev/null || { echo "npm is not there, which brings the scripts that draw graphs and search" >&2 && exit 1; }
    rm -rf "$environment"
    "${PYTHON:-python3}" -m venv "$environment"
    "$environment/bin/python" -m pip install --quiet --requirement docs/requirements-site.txt
    script dist/mermaid.min.js mermaid 11.17.2 \
        57a2b70bc101744b0f1595d228c25eea9a50384371b87011afd1af1d7e21878ee501b84c443f6a7f8a042bb2e869143150b31af34feab798073bbdda0a578106
    script shim/index.js iframe-worker 1.0.4 \
        ae879a688f8b8352c935f8290a3a117bff96cc48f2f7e674f0ba04beef393023db063c26faa5f3f00839534e651dae95d42cac6721b313448e900b52500e6aed
    cat docs/requirements-site.txt scripts/site.sh >"$environment/.complete"
fi
scripts/document.sh --pages >/dev/null
mkdir build/pages/scripts
cp "$environment"/*.js build/pages/scripts
NO_MKDOCS_2_WARNING=1 "$environment/bin/python" -m mkdocs build --quiet --strict
echo "build/site/index.html"
if [[ $# -gt 0 ]]; then
    mkdir -p "$(dirname "$1")"
    tar -czf "$1" -C build site
    echo "$1"
fi
