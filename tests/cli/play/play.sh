# What play computes and writes: the hysteresis loop of Fig. 2, the log, where it reads from.
source "$(dirname "$0")/../lib.sh"
seed "$ball" | expand --complete -o grid

# Functions of libraries are found at the start, and not in a tick.
[[ -n ${HAPGRID_WRAPPER-} ]] || readelf -d "$HAPGRID_BIN/play" | grep -q ' BIND_NOW' || fail "they are found late"

# There and back along y = z = 0 in steps of 0.01; -0.9 .. 0.9 and 0.9 .. -0.9.
{
  echo "# there and back"
  for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0 0"; done
} >path

expect 0 '' "play: 362 ticks, 72 cell switches: 72 face, 0 edge, 0 vertex; the state snapped in 2 ticks
play: ticks outside the box 0, with a jump split 0, lagging behind a jump 0
play: largest force 3 N of the model, 2.03 N sent; safety, in ticks: ramped 362, slewed 2" \
  -- play grid --device path:path --log log

# The log: one line that names the columns, a line a tick.
[ "$(head -1 log)" = $'# t\tx\ty\tz\tforce_x\tforce_y\tforce_z\tsent_x\tsent_y\tsent_z\tl0\tl1\tl2\tl3\tl4\tl5\tl6\tl7\ts0\tenergy\tsnap' ] || fail "header"
awk -F '\t' 'NR > 1 && (NF != 21 || $1 != (NR - 2) / 1000) { bad = 1 } END { exit bad || NR != 363 }' log ||
  fail "lines of the log"
[[ $(sed -n 3p log) == $'0.001\t-0.89000000000000001\t0\t0\t'* ]] || fail "17 digits: $(sed -n 3p log)"

# Pushed from the left the ball is right of x = 0, pushed from the right it is left of it, and it
# hangs at the ends (issue 2). Columns: x is 2, the angle 19.
awk -F '\t' '
  NR == 1 { next }
  $2 == 0 && NR <= 182 { there = $19 }
  $2 == 0 && NR > 182 { back = $19 }
  ($2 < -0.85 || $2 > 0.85) && $19 != 0 { bad = 1 }
  END { exit bad || !(there > 0.15 && back < -0.15 && there + back < 1e-12 && there + back > -1e-12) }' log ||
  fail "hysteresis"

# The same bytes again, on standard output, and with either input through standard input.
play grid --device path:path --log - 2>/dev/null | cmp - log
play - --device path:path --log - <grid 2>/dev/null | cmp - log
play grid --device path:- --log - <path 2>/dev/null | cmp - log
LC_ALL=C.UTF-8 play grid --device path:path --log again 2>/dev/null
cmp again log

# Outside the box, over many cells at once, with a small limit.
printf '%s\n' '-0.95 0.01 0.01' '0 0.01 0.01' '-9 0.01 0.01' >jumps
settings bare.toml 'safety.ramp = 0'
expect 0 '' "play: bare.toml sets safety.ramp = 0
play: 3 ticks, 38 cell switches: 38 face, 0 edge, 0 vertex; the state snapped in 0 ticks
play: ticks outside the box 1, with a jump split 2, lagging behind a jump 0
play: largest force 0.202 N of the model, 0.05 N sent; safety, in ticks: faded 1, clamped 1" \
  -- play grid --device path:jumps --max-force 0.05 --config bare.toml --log log
awk -F '\t' 'NR > 1 && $8 * $8 + $9 * $9 + $10 * $10 > 0.05 * 0.05 * (1 + 1e-15) { bad = 1 }
             NR == 3 && $8 * $8 + $9 * $9 + $10 * $10 < 0.049 * 0.049 { bad = 1 }
             NR == 4 && ($2 != -9 || $19 != 0) { bad = 1 } END { exit bad }' log || fail "limits: $(cat log)"
# A jump over 70 cells takes a second tick: 64 cells are the most in one.
seed "$ball" --set 'grid.origin=[-0.9,0,0]' --set grid.spacing=0.01 --set 'grid.counts=[72,2,2]' \
  --set 'seeds.points=[[-0.9,0,0]]' |
  expand --complete -o long
printf '%s\n' '-0.895 0 0' '-0.195 0 0' '-0.195 0 0' >jump
expect 0 '' "~play: 3 ticks, 70 cell switches: 70 face, 0 edge, 0 vertex; .*
play: ticks outside the box 0, with a jump split 2, lagging behind a jump 1
play: largest force .*" -- play long --device path:jump

# Paced: 300 ticks at 1 kHz end after 299 ms at the earliest; missed ticks only make it longer.
head -301 path >short
begin=$(date +%s%N)
play grid --device path:short --rate 1000 --log log 2>stderr
[ $(($(date +%s%N) - begin)) -ge 299000000 ] || fail "too early"
grep -qx 'play: ticks missed at 1000 Hz: [0-9]*, in [0-9]* overruns\?' stderr || fail "paced: $(cat stderr)"
missed=$(sed -n 's/.*at 1000 Hz: \([0-9]*\),.*/\1/p' stderr)
# The wait that finds the path at its end can miss ticks too: those come after the last line.
awk -F '\t' -v missed="$missed" 'NR > 2 && !($1 > last) { bad = 1 } { last = $1 }
  END { late = last * 1000 - 299; exit bad || late < -1e-6 || late > missed + 1e-6 || NR != 301 }' log ||
  fail "paced log"
