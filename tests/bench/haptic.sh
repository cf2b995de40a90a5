#!/usr/bin/env bash
# The haptic loop: the computing time of a tick, and how late ticks are, beside cyclictest.
#
#   tests/bench/haptic.sh [BUILD] [SECONDS A TURN] [TURNS]        (default: build 5 4)
#
# The computing time goes from a tick's beginning to when its force was sent. It is measured on the hung
# ball and on a molecule of 77 atoms (leu-enkephalin with 12 points a side: a state has 10 numbers), with the
# grid alone. The paced loop's lateness is measured at 1 and 5 kHz,
# in turns with cyclictest at the same priority, interval and length, since a virtual machine's own stalls
# come and go; the medians over the turns are printed.
# Run it as root, or with the limits that real time needs; cyclictest is in Debian's rt-tests.
seconds=${2:-5} turns=${3:-4}
source "$(dirname "$0")/lib.sh"

seed "$ball" | expand --complete -j 2 -o hung-ball.grid
compute leu-enkephalin "$HAPGRID_SOURCE/examples/molecule/leu-enkephalin/leu-enkephalin.toml" 12

# A path that wanders through the inner half of the box, in contact and out of it, at 0.1 box sides a second.
paths() { # GRID RATE
  python3 - "$1" "$2" "$seconds" >path <<'PYTHON'
import json, math, subprocess, sys
grid, rate, seconds = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
get = lambda key: json.loads(subprocess.check_output(["stats", "--get", key, grid]))
origin, h, counts = get("box.origin"), get("box.spacing"), get("box.counts")
for i in range(int(rate * seconds)):
    t = i / rate
    part = [0.5 + 0.3 * math.sin((0.7 + 0.3 * a) * t + a) for a in range(3)]
    print(*(o + h * (n - 1) * p for o, n, p in zip(origin, counts, part)))
PYTHON
}
key() { python3 -c 'import json,sys; r=json.load(open(sys.argv[1])); print(r[sys.argv[2]][sys.argv[3]])' "$@"; }
median() { sort -g | awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }

echo "computing time of a tick, us (aim: p50 5, p99.9 20)"
for model in hung-ball leu-enkephalin; do
  paths "$model.grid" 1000
  play "$model.grid" --device path:path --rate 1000 --beside off --report "$model.json" 2>/dev/null
  printf '  %-16s p50 %s, p99 %s, p99.9 %s, max %s\n' "$model" \
    "$(key "$model.json" compute p50_us)" "$(key "$model.json" compute p99_us)" \
    "$(key "$model.json" compute p99.9_us)" "$(key "$model.json" compute max_us)"
done

# The 99th percentile of cyclictest's histogram of microseconds.
cyclic() { # INTERVAL_US
  cyclictest -q -m -t 1 -p 40 -i "$1" -D "$seconds" -h 20000 2>/dev/null |
    awk '/^[0-9]/ { n += $2; v[$1 + 0] = $2 } END { for (i = 0; i < 20000; ++i) { s += v[i]; if (s >= 0.99 * n) { print i; exit } } }'
}
settings spin.toml 'loop.spin = 60'
for rate in 1000 5000; do
  paths hung-ball.grid "$rate"
  rm -f loop spun kernel
  for _ in $(seq "$turns"); do
    cyclic $((1000000 / rate)) >>kernel
    play hung-ball.grid --device path:path --rate "$rate" --report r.json 2>/dev/null
    key r.json lateness p99_us >>loop
    play hung-ball.grid --device path:path --rate "$rate" --config spin.toml --report r.json 2>/dev/null
    key r.json lateness p99_us >>spun
  done
  printf 'lateness at %s Hz, p99 in us: cyclictest %s, play %s, play with loop.spin = 60 %s\n' "$rate" \
    "$(median <kernel)" "$(median <loop)" "$(median <spun)"
done
