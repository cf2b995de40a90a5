# shellcheck shell=bash disable=SC2154  # variables of lib.sh
# A terminal for tests. A script sources it after lib.sh. It starts a tmux server for this test alone, with
# one pane of 80 x 24 and a shell without history, or skips the test when tmux is not installed.
needs tmux tmux
export LC_ALL=C.UTF-8 # tmux draws block characters only in UTF-8
unset TMUX COLORTERM
on() { tmux -S "$work/tmux" -f /dev/null "$@"; }
trap 'on kill-server 2>/dev/null; rm -rf "$work"' EXIT
# Newer versions of chafa know that tmux has true colour: view is told of another terminal, with 256 colours.
on new-session -d -x 80 -y 24 "env -u TMUX -u TERM_PROGRAM TERM=screen PS1='ready> ' bash --norc --noprofile"

# type_line TEXT: types a line and the return key.
type_line() { on send-keys -l "$1" && on send-keys Enter; }

# wait_line REGEX [FILE]: waits until a line of the terminal matches. If none does, FILE is shown, too.
wait_line() {
  evidence() { on capture-pane -p; cat "$seen_too"; }
  local seen_too=${2:-/dev/null}
  wait_for 60 "line of the terminal: $1" line_fits "$1"
}
line_fits() { on capture-pane -p | grep -qE "$1"; }
