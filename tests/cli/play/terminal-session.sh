# The session that needs no device and no display: keys move the HIP, the picture is in the terminal.
source "$(dirname "$0")/../lib.sh"
export ASAN_OPTIONS=detect_leaks=0 # GLib keeps what it has
command -v tmux >/dev/null || skip "no tmux"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid

export LC_ALL=C.UTF-8
unset TMUX COLORTERM
on() { tmux -S "$work/tmux" -f /dev/null "$@"; }
trap 'on kill-server 2>/dev/null; rm -rf "$work"' EXIT
on new-session -d -x 80 -y 24 "env PS1='ready> ' bash --norc --noprofile"
wait_for() {
  local deadline=$((SECONDS + 60))
  until on capture-pane -p | grep -qE "$1"; do
    ((SECONDS < deadline)) || fail "never on the terminal: $1"$'\n'"$(on capture-pane -p; cat err)"
    sleep 0.05
  done
}
on send-keys -l 'COLORTERM=truecolor play grid --device keys --key-start=-0.4,0,0 --log log.session 2>err | view --terminal; codes=${PIPESTATUS[*]}; clear; echo "codes $codes"'
on send-keys Enter
wait_for '^t [0-9.]+ s   force 0 N'
# To the right until the ball is pushed: its force is on the status line.
for _ in {1..11}; do on send-keys Right; sleep 0.1; done
wait_for '^t [0-9.]+ s   force 0\.[0-9]+ N'
on send-keys -l q
wait_for '^codes 0 0$'
stats --log log.session >report
grep -qE '^flag safety_fault +0 ' report || fail "$(cat report)"
