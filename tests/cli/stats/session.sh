# Sessions: the report, the text, parts of them, pictures; what is damaged, and what can be saved of it.
source "$(dirname "$0")/../lib.sh"

# A session that was made by other programs, with numbers that are known.
session() { python3 "$here/session.py" "$@"; }
session make known
expect 0 "model               ball
grid                -
box                 3 x 2 x 2 points, 0.5 apart, from (-1, 0, 0) m
settings            -
rate                10 Hz
ticks               4, from 0.5 s to 1 s (0.5 s)
missed              2 (33.333 %)
largest force       2 N at 0.6 s as sent, 5 N at 0.6 s before the safety core
energy              1.9 N m given to the hand, at most 1.9 N m until 0.9 s
not computed        1 (25.000 %)
lateness            p50 0.100, p99 4294967.295, p99.9 4294967.295, max 4294967.295 µs
compute time        p50 0.002, p99 0.004, p99.9 0.004, max 0.004 µs
flag clutch         1 (25.000 %)
flag safety_clamped 1 (25.000 %)
flag level_changed  1 (25.000 %)" '' -- stats --log known
session text known >expected
expect 0 '' '' -- stats --log known --export text
cmp expected text
stats --log - --export - <known | cmp expected -
stats --log - --export - < <(cat known) | cmp expected -
# From a tick's own time on, up to another one's without it.
expect 0 "$(sed -n '1p;3,4p' expected)" '' -- stats --log known --from 0.6 --to 1 --export -
expect 0 "$(sed -n '1p;4p' expected)" '' -- stats --log known --from 0.60001 --to 0.99999 --export -
refuses 'stats: known: no tick from --from to --to: it goes from 0.5 s to 1 s' -- \
  stats --log known --from 1.01
mkdir empty
refuses 'stats: known: no tick from --from to --to: .*' -- \
  stats --log known --from 0.7 --to 0.9 --export empty/text
nothing_left empty
stats --log known --format json --from 0.6 --to 0.95 >json
python3 - <<'END'
import json
r = json.load(open("json"))
assert (r["ticks"], r["missed"], r["dropped"], r["lost_bytes"]) == (2, 2, 0, 0)
assert (r["start_s"], r["end_s"], r["rate_hz"]) == (0.6, 0.9, 10)
assert r["largest_raw_force"] == {"newtons": 5, "time_s": 0.6, "tick": 6}
assert r["largest_force"] == {"newtons": 2, "time_s": 0.6, "tick": 6}
assert r["energy"] == {"unit": "N m", "given": 1.2 * 0.25 + 1.6, "returned": 1.2 * 0.25 + 1.6,
                       "returned_time_s": 0.9}
assert r["force_not_computed"] == 1
assert r["flags"] == {"clutch": 1, "safety_clamped": 1, "level_changed": 1}
assert r["lateness_us"]["max"] == 1.5 and r["compute_us"]["p50"] == 0.002
END

# One as play would record it, by hapgrid's own recorder: read by other programs.
"$HAPGRID_BUILD/bench/bench_session" long 9000 >/dev/null
session text long >expected
stats --log long --export - | cmp expected -
same "messages" 5 "$(zstd -dc long | capnp decode --short "$HAPGRID_SOURCE/schemas/session.capnp" Message | wc -l)"
# A part is what a part of the text is, wherever the chunks begin.
for range in "0 0.001" "4.095 4.097" "3.9 8.3" "8.192 100" "0.0005 0.5"; do
  read -r from to <<<"$range"
  awk -v a="$from" -v b="$to" 'NR == 1 || ($1 >= a && $1 < b)' expected >part
  stats --log long --from "$from" --to "$to" --export - | cmp part -
done

# The same report from one that was interrupted, but for the chunk that is not whole.
head -c $(($(stat -c %s long) * 3 / 4)) long >long.part
refuses 'stats: long.part: byte [0-9]+: truncated: no index at its end, as of a session that was interrupted \(stats --salvage takes what is there\)' -- \
  stats --log long.part
stats --log long.part --salvage >report
grep -qE '^ticks +(4096|8192), from 0 s' report ||
  fail "salvaged: $(cat report)"
grep -qE '^salvaged +[1-9][0-9]* bytes of the file are lost$' report || fail "what is lost"
stats --log long.part --salvage --export part
head -n "$(wc -l <part)" expected | cmp part -
stats --log long >whole
stats --log long --salvage | cmp whole -
# A running one can be looked at; the file is not touched.
cmp <(head -c "$(stat -c %s long.part)" long) long.part

SLOW=0
if sanitized; then SLOW=1; fi
export SLOW
session bad known

see='\(see stats --help\)'
printf '# t\tx\ty\tz\n0\t1\t2\t3\n1\t1\t2\t3\n' >log
expect 2 '' "~stats: --log: a log that is text needs --plot and --png $see" -- stats --log log
expect 2 '' "~stats: --log: a log that is text needs --plot and --png $see" -- \
  stats --log log --export -
expect 2 '' "~stats: --from, --to, --export, --npz and --salvage are for sessions, not text $see" -- \
  stats --log log --plot t,x --png x.png --from 1
expect 2 '' "~stats: --plot draws a log that is text; the picture of a session is --png alone $see" -- \
  stats --log known --plot t,x --png x.png
for option in "--from 1" "--to 1" "--export x" "--salvage"; do
  # shellcheck disable=SC2086
  expect 2 '' "~stats: --from, --to, --export and --salvage need --log $see" -- stats known $option
done
for seconds in nan inf up 1s; do
  expect 2 '' "~stats: --from: '$seconds' is not a number of seconds $see" -- \
    stats --log known --from $seconds
done
seed "$ball" -o seeds
refuses 'stats: seeds: byte 0: not a session' -- stats --log seeds
refuses 'stats: .*No space left on device' -- stats --log long --export /dev/full
refuses 'stats: .*No space left on device' -- stats --log known -o /dev/full

needs gnuplot gnuplot-nox
is_png() { /usr/bin/python3 "$here/../view/png.py" size "$1" >/dev/null || fail "$1 is no PNG"; }
for file in known long; do
  expect 0 '' '' -- stats --log $file --png $file.png
  is_png $file.png
done
expect 0 '' '' -- stats --log known --from 0.5 --to 0.6 --png one.png  # a single tick
is_png one.png
stats --log known --from 0.9 --to 1 --png - >clutch.png  # no force was computed
is_png clutch.png
# A picture and a text at once.
expect 0 '' '' -- stats --log long --png both.png --export both
is_png both.png
cmp both expected
rm -f empty/*
refuses 'stats: known: no tick .*' -- stats --log known --from 7 --png empty/x.png
nothing_left empty
