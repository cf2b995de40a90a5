#!/bin/sh
# hapgrid feel GRID [OPTION OF PLAY...]: a page in which the mouse or a finger is the hand. It is play and view, and
# the pipe back through which play hears of the hand.
set -eu

bin=$(dirname "$(readlink -f "$0")")
case ${1-} in
  '')
    echo 'hapgrid: feel: which grid? (see hapgrid --help)' >&2
    exit 2
    ;;
  -h | --help)
    cat <<'EOT'
Usage: hapgrid feel GRID [OPTION OF PLAY...]

Plays GRID in a page of the browser, and writes the page's address: without a
browser here, open it in one that reaches this machine through ssh -L. A drag
of the mouse or a finger moves the hand, the wheel moves it in depth, and the
key h shows all keys. Nothing pushes back, so the picture shows the force: a
thread leads from the ring, which is the hand, to the ball that it pulls. Where
the model resists, the thread grows, and where the model snaps, it shrinks.
Closing the page ends the play. HAPGRID_FEEL_PORT, if set, is the page's port.
EOT
    exit 0
    ;;
esac

test -x "$bin/view" || {
  echo 'hapgrid: feel: view is not built: make -f Makefile.example build' >&2
  exit 1
}
dir=$(mktemp -d "${TMPDIR:-/tmp}/hapgrid-feel.XXXXXX")
trap 'rm -rf "$dir"' EXIT
mkfifo -m 600 "$dir/hand" "$dir/address" "$dir/frames"
# In the background, so that a signal is answered at once. When the page is closed the pipe is, and
# so the play ends in good order.
exec 3<&0
"$bin/play" --device "path:$dir/hand" --frames - "$@" <&3 >"$dir/frames" &
play=$!
"$bin/view" --web --close --hand "$dir/hand" --azimuth 0 --elevation 10 ${HAPGRID_FEEL_PORT+--port "$HAPGRID_FEEL_PORT"} \
  <"$dir/frames" >"$dir/address" 2>"$dir/said" &
page=$!
for signal in 1 2 3 15; do
  # shellcheck disable=SC2064  # the number is meant
  trap "kill $page $play 2>/dev/null || :; wait; exit $((128 + signal))" "$signal"
done
if read -r address <"$dir/address"; then
  echo "hapgrid: feel: $address" >&2
  if test -n "${DISPLAY-}${WAYLAND_DISPLAY-}" && command -v xdg-open >/dev/null; then
    xdg-open "$address" >/dev/null 2>&1 </dev/null 3<&- &
  fi
fi
seen=0 played=0
wait "$page" || seen=$?
# Without a page nobody would ever be the hand that play waits for.
test "$seen" = 0 || kill "$play" 2>/dev/null || :
wait "$play" 2>/dev/null || played=$?  # where the shell would say: Terminated
# Without a play there is nothing to see, and play has said why.
if test "$played" != 0 && test "$played" != 143; then exit "$played"; fi
cat "$dir/said" >&2
exit "$seen"
