#!/bin/bash
# All shell scripts pass shellcheck. Run with a directory, it looks at that one instead.
set -euo pipefail
cd "${1:-${HAPGRID_SOURCE:-$(dirname "$0")/..}}"
command -v shellcheck >/dev/null || { echo "not installed: shellcheck (Debian: shellcheck)"; [[ -z ${CI-} ]] || exit 1; exit 77; }

# Those that are no tests: nothing is excused.
mapfile -t scripts < <(
  find .ci examples tests/*.sh -type f ! -name '*.md' -print0 |
    xargs -0 grep -lIE '^#!/bin/(ba)?sh|^#!/usr/bin/env bash' | sort
)
((${#scripts[@]})) || { echo "no scripts are found" >&2; exit 1; }
shellcheck "${scripts[@]}" >&2

# Tests. SC1091, SC2034, SC2154: what cli/lib.sh sets or reads. SC2046, SC2206: words are split on purpose.
# SC2125: brackets in a setting are no pattern. SC2164: set -e is in cli/lib.sh. SC2238: it takes a file named like a command for a mistake.
find tests -name '*.sh' -print0 |
  xargs -0 shellcheck --severity=warning --exclude=SC1091,SC2034,SC2154,SC2046,SC2125,SC2164,SC2206,SC2238 >&2
