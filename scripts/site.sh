#!/usr/bin/env bash
# Build the documentation as a site with search: build/site/index.html. A broken link ends it with status 1.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
environment=build/site_environment
if ! cmp --silent docs/requirements-site.txt "$environment/requirements.txt"; then
    rm -rf "$environment"
    "${PYTHON:-python3}" -m venv "$environment"
    "$environment/bin/python" -m pip install --quiet --requirement docs/requirements-site.txt
    cp docs/requirements-site.txt "$environment/requirements.txt"
fi
rm -rf build/site_pages
"$environment/bin/python" tools/documentation/site.py . build/site_pages
NO_MKDOCS_2_WARNING=1 "$environment/bin/python" -m mkdocs build --quiet --strict
echo "build/site/index.html"
