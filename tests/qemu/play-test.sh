# play with a device behind a real hidraw: a three-axis device that a text profile describes, at
# 5 kHz in the machine's own time, alone and beside a busy desktop; and unplugged. Other ends are in word-test.sh.
source "$(dirname "$0")/lib.sh"

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o ball.grid
settings play.toml 'safety.ramp = 100'
# The hand: there and back along x, 200 mm a second, as a line a report at 5 kHz and at 1 kHz; then it rests. The
# reach of 0.2 m fills the box of 1.9 along x: 9.5 units a metre.
{ seq -f '%.0f 0 0' -80000 40 19960; seq -f '%.0f 0 0' 20000 -40 -79960; } >positions.txt
seq -f '%.0f 0 0' -80000 200 19960 >thousand.txt
hid_profile '-0.1, -0.1, -0.1' '0.1, 0.1, 0.1' >profile.toml
cat >session <<'END'
# Numbers are computed ten times slower here, which leaves no time for the model.
play="play /ball.grid --device hid:/profile.toml --config /play.toml --beside off"  # to a file: on a pipe it would write frames
device() { rawhid-device "$@" >/tmp/record & device=$!; await /dev/hidraw0; }
over() { kill $device 2>/dev/null; wait $device; while [ -e /dev/hidraw0 ]; do usleep 10000; done; }

echo "== ticks"
device --rate 5000 /positions.txt
$play --rate 5000 --duration 0.5 --log /tmp/log.session --report /tmp/report >/dev/null
echo "exit $?"
over
echo "== report"; cat /tmp/report
echo "== record"; grep ' out ' /tmp/record | cut -d' ' -f3-5
echo "== session"; base64 /tmp/log.session
echo "== busy"  # a desktop that takes all the time that it can get; the device itself is never late
chrt -f 48 rawhid-device --rate 5000 /positions.txt >/tmp/record & device=$!; await /dev/hidraw0
(while :; do :; done) & desktop=$!
$play --rate 5000 --duration 1 --report /tmp/report >/dev/null & player=$!
usleep 900000
for name in hapgrid-hid hapgrid-guard; do
  echo "task $name $(chrt -p "$(pidof $name)" | sed 's/.*: //' | tr '\n' ' ')"
done
wait $player; echo "exit $?"; kill $desktop; over
echo "forces $(grep -c ' out ' /tmp/record)"
echo "== busy report"; cat /tmp/report
echo "== unplugged"
device --rate 1000 --unplug-after 450 /thousand.txt; $play >/dev/null; echo "exit $?"; over
grep ' out ' /tmp/record | awk '{ x = $3 < 0 ? -$3 : $3; if (x > most) most = x } END { print "felt", NR, most }'
echo "== end"
END
TIMEOUT=${TIMEOUT:-900} machine "$qemu/rawhid-device" "$HAPGRID_BIN/play" "$HAPGRID_BIN/hapgrid-guard" "$HAPGRID_BIN/hapgrid-hid" "$HAPGRID_BIN/hapgrid-spacemouse" "$HAPGRID_BIN/hapgrid-evdev" "$HAPGRID_BUILD/models/hung-ball.so" \
  "$(command -v chrt)" ball.grid profile.toml play.toml ./*.txt session -- 'sh session'
printf '%s\n' "$output" >got
python3 "$here/play_test.py" got positions.txt
# What was recorded there gives the same forces here, bit for bit.
play ball.grid --device replay:log.session --log again.session >/dev/null 2>&1
python3 "$HAPGRID_SOURCE/tests/cli/stats/session.py" text again.session >here.txt
cut -f 1-19 there.txt | cmp - <(cut -f 1-19 here.txt) || fail 'the replay has other forces'
