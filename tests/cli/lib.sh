# shellcheck shell=bash disable=SC2034  # variables are for the scripts
# What the command-line tests share. A script sources it in its first line,
#
#   source "$(dirname "$0")/../lib.sh"
#
# It sets -euo pipefail, puts the filters of HAPGRID_BIN first on the PATH (`expand` is also a program
# of coreutils) and Debian's python3, which has Debian's modules, before any other, and goes to a new empty
# directory that is removed at the end.
# ctest sets HAPGRID_BIN, HAPGRID_SOURCE and HAPGRID_BUILD; when a test is run by hand they are guessed.
set -euo pipefail

HAPGRID_SOURCE=${HAPGRID_SOURCE:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)}
HAPGRID_BUILD=${HAPGRID_BUILD:-$HAPGRID_SOURCE/build}
HAPGRID_BIN=${HAPGRID_BIN:-$HAPGRID_BUILD/bin}
export HAPGRID_SOURCE HAPGRID_BUILD HAPGRID_BIN PATH="$HAPGRID_BIN:/usr/bin:$PATH" PYTHONDONTWRITEBYTECODE=1
unset HAPGRID_MODEL_PATH

here=$(cd "$(dirname "$0")" && pwd)  # the script's directory
schema=$HAPGRID_SOURCE/schemas/shard.capnp
ball=$HAPGRID_SOURCE/examples/hung-ball/hung-ball.toml

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/in" "$work/got"
cd "$work/in"

# HAPGRID_WRAPPER is a command, such as valgrind, under which the filters are run. Scripts with their names,
# in a directory that looks like the build's, do that. Since some tests run a filter a thousand times, only
# one run in 25 is under the command from the filter's 11th run in a test on.
if [[ -n ${HAPGRID_WRAPPER-} ]]; then
  mkdir "$work/wrapped" "$work/wrapped/bin"
  ln -s "$(realpath "$HAPGRID_BIN/../models")" "$work/wrapped/models"
  for filter in "$HAPGRID_BIN"/*; do
    if [[ $(head -c 2 "$filter") == '#!' ]]; then
      ln -s "$(realpath "$filter")" "$work/wrapped/bin"
    else
      cat >"$work/wrapped/bin/${filter##*/}" <<END
#!/bin/bash
filter=$(printf %q "$(realpath "$filter")")
printf . >>"\$0.runs" && read -r runs <"\$0.runs"
((\${#runs} > 10 && \${#runs} % 25)) && exec "\$filter" "\$@"
exec $HAPGRID_WRAPPER "\$filter" "\$@"
END
      chmod +x "$work/wrapped/bin/${filter##*/}"
    fi
  done
  HAPGRID_BIN=$work/wrapped/bin PATH=$work/wrapped/bin:$PATH
fi

# dump GRID, or < GRID: its records as text.
dump() { python3 "$HAPGRID_SOURCE/tests/cli/dump.py" "$@"; }

# fail WHAT...: ends the test with a message that names the line of the script.
fail() {
  echo "$0: line ${BASH_LINENO[-2]}: $*" >&2
  exit 1
}

# same WHAT EXPECTED GOT: compares a text. EXPECTED is the text itself, or ~REGEX, an extended regular
# expression that must match all of it (for a text with a path, an id or a time).
same() {
  if [[ $2 == "~"* ]]; then
    [[ $3 =~ ^(${2:1})$ ]] && return
  elif [[ $3 == "$2" ]]; then
    return
  fi
  fail "$1"$'\n'"  expected: $2"$'\n'"  got:      $3"
}

# expect CODE STDOUT STDERR -- COMMAND...: runs a command and compares its exit code and what it writes.
# STDOUT and STDERR are as in same(). Standard input is the caller's.
expect() {
  local code=$1 out=$2 err=$3 got=0
  [[ $4 == -- ]] || fail "expect: -- is missing"
  shift 4
  "$@" >"$work/got/out" 2>"$work/got/err" || got=$?
  # A filter that takes longer than a minute, as it may on a busy machine, tells how far it is.
  LC_ALL=C sed -i -E '/^(expand|merge): .* of .*\/s(,|$)/d; /^verify: [a-z]+: [0-9]+ of [0-9]+ (records|walks)$/d' "$work/got/err"
  [[ $got == "$code" ]] || fail "exit code $got, not $code: $*"$'\n'"$(head -c 2000 "$work/got/err")"
  # $(...) drops final newlines; the dot keeps them. Each text must end with exactly one.
  local text stream
  for stream in out err; do
    text=$(tr -d '\0' <"$work/got/$stream"; echo .)
    text=${text%.}
    [[ -z $text || $text == *$'\n' ]] || fail "std$stream does not end its line: $*"
    same "std$stream of: $*" "${!stream}" "${text%$'\n'}"
  done
}

# refuses REGEX -- COMMAND...: the command must exit with 1, write nothing to standard output, and one
# line that matches to standard error.
refuses() {
  local regex=$1
  shift
  expect 1 '' "~$regex" "$@"
  [[ $(wc -l <"$work/got/err") == 1 ]] || fail "not one line: $(cat "$work/got/err")"
}

# refusals TABLE [COMMAND]: what a program refuses. A row of the table has four cells, with tabs between them: the exit code;
# what the script's function input() is given first, or nothing; the command, or nothing for COMMAND; and the message, as in
# same(), in which $NAME is a variable of the script. Each row must write one line to standard error and nothing to
# standard output, and leave no file `out`.
refusals() {
  local code input command message rows=0
  while IFS=$'\x1f' read -r -u 3 code input command message; do
    [[ $code && $code != '#'* ]] || continue
    [[ ! $input ]] || input "$input"
    while [[ $message =~ \$([A-Za-z_]+) ]]; do message=${message//"${BASH_REMATCH[0]}"/"${!BASH_REMATCH[1]}"}; done
    expect "$code" '' "$message" -- eval "${command:-$2} # $input"
    [[ $(wc -l <"$work/got/err") == 1 ]] || fail "not one line: $(cat "$work/got/err")"
    [[ ! -e out ]] || fail "half a file: ${command:-$2} # $input"
    ((++rows))
  done 3< <(tr '\t' '\037' <"$1")  # read takes several tabs for one
  ((rows)) || fail "no row in $1"
}
input() { eval "$1"; }

# wait_for SECONDS WHAT COMMAND...: waits until the command succeeds. If it never does, the test fails and
# shows what evidence() prints; a test may define that function.
wait_for() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    ((SECONDS < deadline)) || fail "no $what"$'\n'"$(evidence 2>&1)"
    sleep 0.05
  done
}
evidence() { :; }

# in_time ERRORS COMMAND...: runs a command in a subshell. A machine that stands still for 100 ms makes play let go of the
# device, as it should, and a browser sometimes hangs on a busy machine. Where the file ERRORS says that this has happened,
# the command gets another attempt, of three. Each attempt adds a line, its test and number, to the file HAPGRID_ATTEMPTS, if
# that is set: `.ci/night` counts them.
in_time() {
  local attempt code
  for attempt in 1 2 3; do
    [[ ! ${HAPGRID_ATTEMPTS-} ]] || echo "${0##*/} $attempt" >>"$HAPGRID_ATTEMPTS"
    set +e
    (set -e; "${@:2}")
    code=$?
    set -e
    ((code)) || return 0
    grep -E 'the haptic loop hangs|did not answer within 100 ms|^Chromium hangs' "$1" || exit $code
    echo "RETRIED: attempt $attempt of 3: the machine stood still"
  done
  exit $code
}

# decode FILE...: prints the shards as JSON, a line for each message, with the stock tools.
decode() { zstd -dc "$@" | capnp convert binary:json --short "$schema" Message; }

# header FILE FIELD: prints a number or name from a shard's first header, with the stock tools. What follows is not decoded.
header() {
  { zstd -dc "$1" | capnp decode --short "$schema" Message 2>/dev/null || true; } |
    sed -nE "1{s/.*[( ]$2 = \"?([^,\") ]*).*/\1/p;q}"
}

# nothing_left DIRECTORY NAME...: the directory must hold these files and no others, hidden ones included.
nothing_left() {
  local directory=$1
  shift
  same "files in $directory" "$(printf '%s\n' "$@" | sort)" "$(ls -A "$directory" | sort)"
}

# rounds GRID OUT OPTION...: runs rounds of expand and merge, through a pipe, until the frontier is empty; options of expand.
rounds() {
  cp "$1" "$2"
  local old=-1 new
  while new=$(header "$2" generation); [[ $new != "$old" ]]; do
    old=$new
    expand "$2" "${@:3}" | merge "$2" - -o "$2.new"
    mv "$2.new" "$2"
  done
}

# stuck_grid CRASH: makes the grid stuck.CRASH of the test plug-in `stuck`: half a newton along x, until a HIP
# beyond x = 0.5 hangs the force function, or makes it crash.
stuck_grid() {
  cat >stuck.toml <<TOML
model = {plugin = "stuck", parameters = {crash = $1}}
grid = {origin = [-1, -1, -1], spacing = 0.5, counts = [5, 5, 5]}
TOML
  export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
  seed stuck.toml | expand --complete -o "stuck.$1"
}

# settings FILE LINE...: a file of play's --config with these lines in its table [play].
settings() { printf '%s\n' '[play]' "${@:2}" >"$1"; }

# sanitized: whether the filters have sanitizers or a wrapper, which cost memory and time.
sanitized() { [[ -n ${HAPGRID_WRAPPER-} ]] || grep -q '^HAPGRID_SANITIZE:[A-Z]*=.' "$HAPGRID_BUILD/CMakeCache.txt"; }

# skip WHY: ends the test as skipped, because it makes no sense here.
skip() {
  echo "skipped: $*"
  exit 77
}

# missing WHAT: says what is left out since a package is not installed. In check-all (CI is set) the test fails instead.
missing() {
  [[ -z ${CI-} ]] || fail "not installed: $*"
  echo "not installed: $*"
}

# needs PROGRAM PACKAGE: ends the test as skipped, or as failed in check-all, where the program is not installed.
needs() { PATH=$PATH:/usr/sbin command -v "$1" >/dev/null || { missing "$1 (Debian: $2)"; exit 77; }; }

# needs_python MODULES PACKAGES: the same for modules of the system's Python, as in "numpy, scipy".
needs_python() { /usr/bin/python3 -c "import $1" 2>/dev/null || { missing "$1 for Python (Debian: $2)"; exit 77; }; }
