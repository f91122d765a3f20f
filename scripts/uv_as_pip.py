"""What pip is told by its configuration, as variables of uv for bash; a variable that is set stays as it is.

Standard input is what `pip config list` prints.
"""

import ast
import os
import shlex
import sys

# By the option of pip the variable of uv, an older name of it, and what stands between several
# values.
VARIABLES = {
    "index-url": ("UV_DEFAULT_INDEX", "UV_INDEX_URL", " "),
    "extra-index-url": ("UV_INDEX", "UV_EXTRA_INDEX_URL", " "),
    "find-links": ("UV_FIND_LINKS", "", ","),
    "no-index": ("UV_NO_INDEX", "", " "),
    "trusted-host": ("UV_INSECURE_HOST", "", " "),
    "proxy": ("ALL_PROXY", "HTTPS_PROXY", " "),
    "cert": ("SSL_CERT_FILE", "", " "),
    "client-cert": ("SSL_CLIENT_CERT", "", " "),
    "timeout": ("UV_HTTP_TIMEOUT", "", " "),
}
SECTIONS = ("global", "install", ":env:")  # a later one goes before those in front of it


def variables(listed: str) -> dict[str, str]:
    """The variables that the lines of `pip config list` lead to."""
    told: dict[str, dict[str, str]] = {section: {} for section in SECTIONS}
    for line in listed.splitlines():
        key, _, value = line.partition("=")
        section, _, option = key.rpartition(".")
        if section in told and option in VARIABLES:
            told[section][option] = str(ast.literal_eval(value))
    # as pip does: the hashes say which file is meant
    found = {"UV_INDEX_STRATEGY": "unsafe-best-match"}
    for option, value in {**told["global"], **told["install"], **told[":env:"]}.items():
        name, older, between = VARIABLES[option]
        if older not in os.environ:
            found[name] = between.join(value.split())
    return {name: value for name, value in found.items() if name not in os.environ}


if __name__ == "__main__":
    for name, value in variables(sys.stdin.read()).items():
        print(f"export {name}={shlex.quote(value)}")
