# shellcheck shell=bash disable=SC2154  # variables of lib.sh
# A terminal for tests: sourced behind lib.sh, it starts a tmux server of the test's own with one pane
# of 80 x 24 and a shell that has a small prompt and no history, or skips where there is no tmux.
command -v tmux >/dev/null || skip "no tmux"
export LC_ALL=C.UTF-8 # tmux draws blocks only where text is UTF-8
unset TMUX COLORTERM
on() { tmux -S "$work/tmux" -f /dev/null "$@"; }
trap 'on kill-server 2>/dev/null; rm -rf "$work"' EXIT
on new-session -d -x 80 -y 24 "env PS1='ready> ' bash --norc --noprofile"

# type_line TEXT: and the return key.
type_line() { on send-keys -l "$1" && on send-keys Enter; }

# wait_for REGEX [FILE]: until a line of the terminal fits. FILE is shown when none does.
wait_for() {
  local deadline=$((SECONDS + 60))
  until on capture-pane -p | grep -qE "$1"; do
    ((SECONDS < deadline)) || fail "never on the terminal: $1"$'\n'"$(on capture-pane -p; cat "${2:-/dev/null}")"
    sleep 0.05
  done
}
