#!/bin/sh
# hapgrid feel GRID [-o FILE.html] [OPTION OF VIEW...]: a page that plays the grid by itself, in which the mouse or a
# finger is the hand. view makes it; this opens it.
set -eu

bin=$(dirname "$(readlink -f "$0")")
case ${1-} in
  -h | --help)
    cat <<'EOT'
Usage: hapgrid feel GRID [-o FILE.html] [OPTION OF VIEW...]

Writes a page that plays GRID by itself, and opens it in the browser. The page
is one file, which needs neither hapgrid nor a network: with -o it is kept, and
can be sent to others or put on any web server, also for phones. A drag of the
mouse or a finger moves the hand, the wheel moves it in depth, and the key h
shows all keys. Nothing pushes back, so the picture shows the force: a thread
leads from the ring, which is the hand, to the ball that it pulls. Where the
model resists, the thread grows, and where the model snaps, it shrinks. The
button path saves where the ball went, for play --device path:FILE. Options are
those of view for the picture, such as --style sticks.
EOT
    exit 0
    ;;
esac

file=
left=$#
while test "$left" -gt 0; do
  argument=$1 left=$((left - 1))
  shift
  case $argument in
    -o | --output)
      test "$left" -gt 0 || { echo "hapgrid: feel: $argument: which file? (see hapgrid feel --help)" >&2; exit 2; }
      file=$1 left=$((left - 1))
      shift
      ;;
    --output=*) file=${argument#--output=} ;;
    *) set -- "$@" "$argument" ;;
  esac
done
test $# -gt 0 || {
  echo 'hapgrid: feel: which grid? (see hapgrid --help)' >&2
  exit 2
}
test -x "$bin/view" || {
  echo 'hapgrid: feel: view is not built: make -f Makefile.example build' >&2
  exit 1
}
if test -n "$file"; then
  "$bin/view" --html "$file" "$@"
  test "$file" != - || exit 0
  said=$file
else
  # A browser reads it when this has ended: it stays until the system clears such files.
  dir=$(mktemp -d "${TMPDIR:-/tmp}/hapgrid-feel.XXXXXX")
  trap 'rm -rf "$dir"; exit 1' HUP INT QUIT TERM
  file=$dir/feel.html code=0
  "$bin/view" --html "$file" "$@" || code=$?
  test "$code" = 0 || { rm -rf "$dir"; exit "$code"; }
  said="$file (-o FILE.html keeps it)"
fi
echo "hapgrid: feel: open in a browser: $said" >&2
if test -n "${SSH_CONNECTION-}"; then
  echo "hapgrid: feel: over ssh: on your own machine, scp $(uname -n):$(realpath "$file") . and open it there" >&2
elif test -n "${DISPLAY-}${WAYLAND_DISPLAY-}" && command -v xdg-open >/dev/null; then
  xdg-open "$file" >/dev/null 2>&1 </dev/null &
elif test "$(id -u)" = 0 && test "$said" != "$file"; then
  echo 'hapgrid: feel: only root can read it there; -o FILE.html puts it elsewhere' >&2
fi
