# shellcheck shell=bash
# An X server without a screen. A script sources it after lib.sh.
needs Xvfb xvfb

# start_x ARGUMENTS...: a server with a number of its own, which ends with the script; DISPLAY is its.
servers=()
trap 'kill "${servers[@]}" 2>/dev/null; rm -rf "$work"' EXIT
start_x() {
  : >display
  Xvfb -displayfd 3 -screen 0 1100x800x24 -nolisten tcp -noreset "$@" 3>display >xvfb.log 2>&1 &
  servers+=($!)
  wait_for 60 "X server" test -s display
  DISPLAY=:$(cat display)
  export DISPLAY
}
