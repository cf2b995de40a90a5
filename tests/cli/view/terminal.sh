# The terminal of view, in tmux and in script(1): that the picture is that of --png, the numbers below
# it, the terminal as before after every way out, and that the keyboard is left to others.
source "$(dirname "$0")/../lib.sh"
export ASAN_OPTIONS=detect_leaks=0 # GLib keeps what it has
frames=$HAPGRID_SOURCE/schemas/frame.capnp

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
settings bare.toml 'safety.ramp = 0'
play grid --device path:path --config bare.toml --frames x.frames 2>/dev/null
# messages SED: those of the frames.
messages() { capnp decode --short "$frames" Message <x.frames | sed -n "$1" | capnp encode "$frames" Message; }
messages '1p;5p' >one
messages '1p;6p' >two
# picture FILE PNG OPTIONS...: its frame by a camera that shows the whole box, as that of a live play: the HIP is in two
# corners later.
{ printf -- '-9 -9 -9\n%.0s' {1..500}; printf '9 9 9\n%.0s' {1..500}; } >corners
play grid --device path:corners --frames corners.frames 2>/dev/null
capnp decode --short "$frames" Message <corners.frames | sed -n '12p;$p' | capnp encode "$frames" Message >corners
picture() { cat "$1" corners >"$1.boxed"; view "$1.boxed" --at 0 --png "${@:2}"; }
time_s=$(capnp decode --short "$frames" Message <two | sed -nE 's/.*time = ([0-9.]+),.*/\1/p')
picture one one.png --size 640x368

see='(see view --help)'
refuses 'view: --terminal: standard output is not a terminal; --png draws a frame into a file' -- \
  view one --terminal
expect 2 '' "view: --terminal: text not in {auto,symbols,sixel} $see" -- view one --terminal=text
expect 2 '' "view: --png excludes --terminal $see" -- view one --terminal --png x

source "$here/../tmux.sh"
tty=$(on display -p '#{pane_tty}')

# start LINE: types a line that shows frames from a pipe which stays open, and waits for the first one.
mkfifo live
start() {
  type_line "$1"
  exec 4>live
  cat one >&4
  wait_line '^t [0-9.]+ s   force '
}

type_line 'clear; seq 3; stty -a >modes'
wait_line '^3$'
wait_line '^ready>$'
before=$(on capture-pane -p)

# shows PNG COLUMNS ROWS: whether the upper rows of the terminal are this picture.
shows() {
  on capture-pane -epN >capture
  python3 "$here/terminal.py" cells capture "$@"
}

# True colour: the picture, then the numbers in the last line.
start "COLORTERM=truecolor view live --terminal"
wait_line '^t '
shows one.png 80 23
grep -q '38;2;' capture || fail "no true colour"
line=$(on capture-pane -p | tail -1)
force='force [0-9.]+ N   energy [0-9.]+ N rope lengths'
same "numbers" "~t [0-9.]+ s   $force" "$line"
same "cursor, screen" "0 1" "$(on display -p '#{cursor_flag} #{alternate_on}')"
# Nobody changed how the terminal takes its input.
stty -F "$tty" -a | cmp - modes
# The next frame replaces it, in another size too.
tail -c +$(($(messages 1p | wc -c) + 1)) two >&4
wait_line "^t ${time_s}0* s "
# In any size the picture is the same, and not sheared.
for size in 60x18 131x48 61x18 67x23 79x24 83x31 97x40 113x47; do
  columns=${size%x*} rows=$((${size#*x} - 1))
  on resize-window -x "$columns" -y "${size#*x}"
  picture two two.png --size $((8 * columns))x$((16 * rows))
  wait_for 60 "picture of $size" shows two.png "$columns" "$rows"
done
on resize-window -x 80 -y 24
# Interrupted: everything is as before.
on send-keys C-c
wait_line '^ready>$'
type_line 'echo exit $?'
wait_line '^exit 130$'
# usual: the usual screen, and a cursor.
usual() { same "cursor, screen" "1 0" "$(on display -p '#{cursor_flag} #{alternate_on}')"; }
# unchanged WHAT: that, with what was on it before, and more below.
unchanged() {
  local now
  now=$(on capture-pane -p)
  [[ $now == "$before"* ]] || fail "screen after $1"$'\n'"$now"
  usual
}
unchanged '^C'
exec 4>&-

# Terminated; and without COLORTERM the 256 colours of TERM.
type_line clear
wait_line '^ready>$'
before='ready>'
start "env -u COLORTERM view live --terminal=symbols & wait; echo exit \$?"  # which newer tmux sets
on capture-pane -epN >capture
grep -q '[34]8;5;' capture || fail "no 256 colours"
grep -q '38;2;' capture && fail "true colour, which nobody promised"
view=$(pgrep -P "$(on display -p '#{pane_pid}')")
kill "$view"
wait_line '^exit '
unchanged SIGTERM
exec 4>&-

# The end of the stream: the last picture stays on the terminal itself. What was typed meanwhile is
# still there for whoever reads it.
type_line clear
wait_line '^ready>$'
start 'view live --terminal; echo exit $?'
type_line 'echo ty""ped'
exec 4>&-
wait_line '^exit 0$'
wait_line '^typed$'
usual
same "numbers" "~t 0\.12 s   force .*" "$(on capture-pane -p | grep '^t ')"

# What play says at its end stays on the usual screen, below the last picture or before it. A terminal's
# window that shows the frames does not end with them, and play does not wait for it.
type_line clear
wait_line '^ready>$'
type_line 'play grid --device keys --frames - | view --terminal'
wait_line '^arrows: x, z .* q: end'
wait_line '^t '
type_line q
wait_line '^ready>$'
wait_line '^play: frames written [0-9]+, dropped '
wait_line '^play: lateness p50 '
usual

# Sixels, forced: what is sent is decoded.
needs script bsdutils
shown() { script -qec "stty cols 80 rows 22; view one.boxed --terminal=$1" /dev/null </dev/null >out; }
shown sixel
view one.boxed --png low.png --size 640x336
python3 "$here/terminal.py" sixel out low.png
# xterm leaves sixels that are wider than 1,000 pixels blank.
script -qec "stty cols 260 rows 70; view one --terminal=sixel" /dev/null </dev/null >wide
python3 - <<'PYTHON'
import re
sizes = [int(size) for size in re.findall(rb'\x1bP[0-9;]*q"\d+;\d+;(\d+);\d+', open("wide", "rb").read())]
assert sizes and 500 < max(sizes) <= 1000, sizes
PYTHON
# Block letters are for locales that have them.
LC_ALL=C script -qec "stty cols 80 rows 24; view one --terminal=symbols" /dev/null </dev/null >plain
LC_ALL=C grep -q 'force' plain || fail "no picture in the locale C"
! LC_ALL=C grep -qP '[\x80-\xff]' plain || fail "letters that the locale C does not have"
