#!/bin/bash
# Which lines of libcore the tests reach: a table by folder, and build-coverage/index.html line by line.
set -euo pipefail
cd "$(dirname "$0")/.."
.ci/packages demo build check coverage
cmake --preset coverage >/dev/null
cmake --build --preset coverage
find build-coverage -name '*.gcda' -delete
# Each process adds its counts to these files when it ends. They are lost where it is stopped in the
# middle of that, by a full disk or a limit: so three tests are left out. What is said about lost counts
# goes to a file, because tests compare standard error.
export GCOV_ERROR_FILE=$PWD/build-coverage/lost-counts
rm -f "$GCOV_ERROR_FILE"
ctest --preset coverage -j "$(nproc)" -E '^bad/(faults|io|limits)$'
[[ ! -s $GCOV_ERROR_FILE ]] || { echo "some counts are lost: $GCOV_ERROR_FILE"; head -n 5 "$GCOV_ERROR_FILE"; }
gcovr -r . -f libcore/ --exclude-throw-branches -j "$(nproc)" build-coverage \
  --html-details build-coverage/index.html --json-summary build-coverage/lines.json
/usr/bin/python3 - build-coverage/lines.json <<'PYTHON'
import collections, json, os, sys
reached, lines = collections.Counter(), collections.Counter()
for file in json.load(open(sys.argv[1]))["files"]:
    for folder in os.path.dirname(file["filename"]), "libcore in all":
        reached[folder] += file["line_covered"]
        lines[folder] += file["line_total"]
for folder in sorted(lines):
    print(f"{folder:18} {100 * reached[folder] / lines[folder]:6.1f} % of {lines[folder]:5} lines")
PYTHON
