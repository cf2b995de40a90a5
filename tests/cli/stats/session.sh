# Sessions: the report; what is cut or damaged. arrays.sh has the ticks.
source "$(dirname "$0")/../lib.sh"

# A session that was made by other programs, with numbers that are known.
session() { python3 "$here/session.py" "$@"; }
session make known
expect 0 "$(<"$here/known.txt")" '' -- stats known
stats known >report
stats - <known | cmp report -
stats - < <(cat known) | cmp report -
stats known --format json >json
python3 - <<'END'
import json
r = json.load(open("json"))
assert (r["ticks"], r["missed"], r["dropped"], r["ended_early"]) == (4, 2, 0, None)
assert (r["start_s"], r["end_s"], r["rate_hz"]) == (0.5, 1, 10)
assert r["largest_raw_force"] == {"newtons": 5, "time_s": 0.6, "tick": 6}
assert r["largest_force"] == {"newtons": 2, "time_s": 0.6, "tick": 6}
assert r["energy"] == {"unit": "N m", "given": 1.2 * 0.25 + 1.6, "returned": 1.2 * 0.25 + 1.6,
                       "returned_time_s": 0.9}
assert r["force_not_computed"] == 1
assert r["flags"] == {"clutch": 1, "safety_clamped": 1, "level_changed": 1}
assert r["lateness_us"]["max"] == 4294967.295 and r["compute_us"]["p50"] == 0.002
END

# One that play has recorded: read by other programs.
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {1..9000}; do echo "$(printf '%de-4' $((i % 4000 - 5000))) 0.01 0"; done >path
play grid --device path:path --log long.session 2>/dev/null
mv long.session long
same "messages" 4 "$(zstd -dc long | capnp decode --short "$HAPGRID_SOURCE/schemas/session.capnp" Message | wc -l)"
# A play that was killed, in the middle of its last write: the whole chunks, and a line that says so.
size=$(($(stat -c %s long) * 3 / 4))
head -c "$size" long >cut
stats cut >report
grep -qE "^ended early +at byte [0-9]+ of $size: a zstd frame is cut\$" report || fail "cut: $(cat report)"
grep -qE '^ticks +(4096|8192), from 0 s' report || fail "cut: $(cat report)"
expect 0 '' "~stats: cut: the session ended early, at byte [0-9]+ of $size: a zstd frame is cut" -- \
  stats cut --npy part
stats long --npy whole
/usr/bin/python3 -c 'import numpy; part, whole = map(numpy.load, ("part", "whole"))
assert len(part) in (4096, 8192) and (part == whole[:len(part)]).all(), len(part)'

SLOW=0
if sanitized; then SLOW=1; fi
export SLOW
session bad known

see='(see stats --help)'
echo '{}' >cost
for option in '--get records' '--cost cost'; do
  # shellcheck disable=SC2086  # words
  expect 2 '' "stats: known: is a session; --get and --cost are for grids $see" -- stats known $option
done
refuses 'stats: .*No space left on device' -- stats long --npy /dev/full
refuses 'stats: .*No space left on device' -- stats known -o /dev/full
