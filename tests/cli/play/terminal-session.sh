# The session that needs no device and no display: keys move the HIP, the picture is in the terminal.
source "$(dirname "$0")/../lib.sh"
export ASAN_OPTIONS=detect_leaks=0 # GLib keeps what it has
source "$here/../tmux.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid

settings start.toml 'mapping.offset = [-0.375, 0.025, 0.025]'
type_line 'COLORTERM=truecolor play grid --device keys --config start.toml --log log.session --frames - 2>err | view --terminal; codes=${PIPESTATUS[*]}; clear; echo "codes $codes"'
wait_line '^t [0-9.]+ s   force 0 N' err
# To the right until the ball is pushed: its force is on the status line.
for _ in {1..11}; do on send-keys Right; sleep 0.1; done
wait_line '^t [0-9.]+ s   force 0\.[0-9]+ N' err
on send-keys -l q
wait_line '^codes 0 0$' err
stats log.session >report
grep -qE '^flag safety_fault +0 ' report || fail "$(cat report)"
