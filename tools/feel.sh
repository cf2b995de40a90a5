#!/bin/sh
# hapgrid feel GRID [OPTION OF PLAY...]: a window in which the mouse is the hand. It is play and view, and the
# pipe back through which play hears of the mouse.
set -eu

bin=$(dirname "$(readlink -f "$0")")
case ${1-} in
  '')
    echo 'hapgrid: feel: which grid? (see hapgrid --help)' >&2
    exit 2
    ;;
  -h | --help)
    cat <<'EOF'
Usage: hapgrid feel GRID [OPTION OF PLAY...]

Plays GRID in a window. The mouse is the hand, the wheel moves it in depth, and
the key h shows all keys. A mouse cannot push back, so the picture shows the
force: where the model resists, the HIP lags behind the hand, and where the
model snaps, the HIP follows.
EOF
    exit 0
    ;;
esac

test -x "$bin/view" || {
  echo 'hapgrid: feel: view is not built: make -f Makefile.example build' >&2
  exit 1
}
test -n "${DISPLAY-}${WAYLAND_DISPLAY-}" || {
  echo 'hapgrid: feel: no display for the window; play --device keys | view --terminal needs none' >&2
  exit 1
}
dir=$(mktemp -d "${TMPDIR:-/tmp}/hapgrid-feel.XXXXXX")
trap 'rm -rf "$dir"' EXIT
mkfifo -m 600 "$dir/hand"
# In the background, so that a signal is answered at once. When the window is closed the pipe is, and
# so the play ends in good order.
exec 3<&0
{ "$bin/play" --device "path:$dir/hand" --frames - "$@" <&3 || echo $? >"$dir/failed"; } |
  "$bin/view" --window --close --hand "$dir/hand" --size 1000x720 --azimuth 0 --elevation 10 2>"$dir/said" &
window=$!
for signal in 1 2 3 15; do
  # shellcheck disable=SC2064  # the number is meant
  trap "kill $window 2>/dev/null || :; wait; exit $((128 + signal))" "$signal"
done
seen=0
wait "$window" || seen=$?
wait
# Without a play there is nothing to see, and play has said why.
test ! -e "$dir/failed" || exit "$(cat "$dir/failed")"
cat "$dir/said" >&2
exit "$seen"
