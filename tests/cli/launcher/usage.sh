# A mistake in a command line: one line, exit code 2, and nothing is read or written. Options that one filter alone has
# are in its own folder; help.sh looks at the help.
source "$(dirname "$0")/../lib.sh"

seed "$ball" -o seeds
expand seeds -o requests
without() { # MODULE COMMAND WORD...: hapgrid COMMAND where Python lacks a module
  /usr/bin/python3 -c 'import runpy, sys
sys.path.insert(0, sys.argv.pop(1))
sys.modules[sys.argv.pop(1)] = None
runpy.run_module("hapgrid.apps." + sys.argv.pop(1), run_name="__main__")' "$HAPGRID_BIN/../python" "$@"
}
refusals "$here/usage.tsv"
nothing_left . seeds requests
# Progress is shown on a terminal, never in a log.
expect 0 '' '' -- expand --complete seeds -o out
