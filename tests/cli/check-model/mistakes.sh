# The mistakes of owners of models, each made as its owner would make it: check-model names it.
source "$(dirname "$0")/../lib.sh"

cat >mistaken.py <<'PYTHON'
import math
import random
import time
import hapgrid


class Bead:
    """A bead on a rail, held by a spring at 0 and pulled by the HIP; what is mistaken is told by name."""

    def __init__(self, mistake):
        self.mistake, self.asked, self.kept = mistake, 0, []
        if mistake == "loads":  # a network
            time.sleep(2)
        self.description = {"state_size": 2, "d_max": 2.0, "tolerance": 1e-6, "energy_unit": "J", "force_scale": 1}
        if mistake == "no scale":
            del self.description["force_scale"]
        if mistake == "wide":  # of the tolerance
            self.description["tolerance"] = 5e-3
        if mistake == "zero":
            self.description["stored"] = ["force"]
        if mistake == "no force":
            self.force = self.energy = None
            self.description["stored"] = []

    def known_states(self, x):
        return [[x[0] / 2, 0.0]]

    def convert(self, s, x, d):
        self.asked += 1
        place = (x[0] + d[0]) / 2
        if self.mistake == "last bits":  # they depend on history
            place += self.asked % 2 * 1e-13
        if self.mistake == "history":
            place += self.asked % 2 * 1e-4
        if self.mistake == "leak":
            self.kept.append(b"x" * 20000)
        if self.mistake == "wide":
            place += 1e-3 * (d[0] > 0)
        if self.mistake == "edge" and x[0] + d[0] > 1.9:
            raise RuntimeError("the mesh is inverted")
        if self.mistake == "halves":  # another state at rest
            place += (round(s[0] - x[0] / 2) + (max(map(abs, d)) > 0.4)) % 2
        if self.mistake == "damped":  # an engine whose damping begins above a velocity: it stops before it is at rest
            place = s[0] + (place - s[0]) * (1 - 0.01 * (abs(place - s[0]) > 0.01))
        if self.mistake == "slow":
            time.sleep(0.3)
        if self.mistake == "top":  # a solver of force = 0 finds the top of a barrier, and stays there until it is pushed
            return [place, math.copysign(1, s[1]) if s[1] else 0.0]
        return [place, 0.0]

    def force(self, s, x):
        force = [s[0] - x[0], -x[1], -x[2]]
        if self.mistake == "one of three" and x[0] > 0:
            force[1] = math.nan
        if self.mistake == "axis":
            force[0] *= 0.97
        if self.mistake == "zero":
            force = [0, 0, 0]
        if self.mistake == "sign":
            force = [-f for f in force]
        if self.mistake in ("thousand", "strong"):
            force = [1000 * f for f in force]
        return force

    def energy(self, s, x):
        scale = 1000 if self.mistake == "strong" else 1
        return scale * (s[0]**2 / 2 + (x[0] - s[0])**2 / 2 + x[1]**2 / 2 + x[2]**2 / 2)


hapgrid.serve(Bead)
PYTHON
define() {
  cat <<TOML
model = {process = ["/usr/bin/python3", "mistaken.py"], name = "mistaken", parameters = {mistake = "$1"}}
grid = {origin = [-2, 0, 0], spacing = 0.5, counts = [9, 3, 3]}
TOML
}
# finds MISTAKE CODE REGEX VERDICT
finds() {
  define "$1" >mistaken.toml
  expect "$2" "~$3" "~$4" -- check-model mistaken.toml --allow-process --steps 60
}
while IFS=$'\t' read -r -u 3 code mistake report verdict; do
  [[ $code == '#'* ]] || finds "$mistake" "$code" "${report//'$nl'/$'\n'}" "$verdict"
done 3<"$here/mistakes.tsv"
# A step that failed is no other state.
finds edge 3 '.*RuntimeError: the mesh is inverted \(mistaken\.py, line [0-9]+\).*' 'check-model: broken: defined .*'
grep -qE '^returns .* 0  note$' "$work/got/out" || fail 'a step back that failed is another state'
finds top 3 '.*stable +60 states +60  broken.*' 'check-model: broken: stable \(60 of 60\)'
grep -qE 'falls to [(]?-?[0-9.]+, -?1[)]? and to [(]?-?[0-9.]+, -?1[)]?$' "$work/got/out" || fail 'not where it falls to'
seed mistaken.toml --allow-process | expand --complete --allow-process mistaken.toml -o top.grid
expect 3 "~.*stable +81 records +81  broken.*" '~verify: broken: stable \(81 of 81\)' -- verify top.grid --allow-process mistaken.toml

# What a model takes to start is no conversion, and its time is not that of the walks.
define loads >loads.toml
expect 0 "~.*start +[2-9][0-9.]* s"$'\n'"conversion +median [0-9.]+ (µs|ms), .*.*.* on one core.*" '~check-model: fine: 10 checks' -- \
  check-model loads.toml --allow-process --steps 60 --seconds 1.5
# Two conversions tell nothing of the others.
define slow >slow.toml
expect 0 "~.*whole grid +no estimate, because too few steps: [0-9] conversions? tells? nothing of the others\. .*.*" '~check-model: fine: .*' -- \
  check-model slow.toml --allow-process --seconds 1

# Rows of convert_many() that iterate until the last one has converged: each depends on the others.
cat >rows.py <<'PYTHON'
import hapgrid
import numpy as np


class Rows:
    description = {"state_size": 1, "d_max": 3, "tolerance": 1e-6}

    def convert_many(self, s, x, d):
        target = np.tanh((x + d)[:, :1] * (1 + (x + d)[:, 1:2]**2))
        while np.max(np.abs(s - target)) > 1e-8:
            s = s + 0.5 * (target - s)
        return {"s": s, "force": -s * [1, 0, 0]}

    def force(self, s, x):
        return [-s[0], 0, 0]

    def known_states(self, x):
        return self.convert_many(np.zeros((1, 1)), np.array([x]), np.zeros((1, 3)))["s"]


hapgrid.serve(Rows)
PYTHON
sed 's/mistaken/rows/g; s/, parameters = {.*}}/}/' slow.toml >rows.toml
expect 3 "~.*among: C answers otherwise when it is asked several questions at a time: a row of convert_many\(\) depends on the others.*.*, by [0-9.]+e-[0-9]+"$'\n'".*" \
  '~check-model: broken: among \([0-9]+ of 60\)' -- check-model rows.toml --allow-process --steps 60

# A slow model: no conversion of the walks begins after their time, though a step takes a dozen. Each takes 0.3 s.
check-model slow.toml --allow-process --seconds 2 --format json -o slow.json 2>/dev/null || true
python3 -c '
import json
rows = {row["name"]: row["counted"] for row in json.load(open("slow.json"))["checks"]}
assert 1 <= rows["defined"] <= 8, rows
'

# A descent that leaps: the truss snaps where it meets no limit point. Steps of any length, as those of the minimisers of
# SciPy and ASE, and of relax(), which cannot leap.
cp "$HAPGRID_SOURCE/tests/python/models/truss.py" .
for minimiser in leap relax; do
  if [[ $minimiser == leap ]]; then substep=0.7; else substep=0.05; fi
  cat >truss.toml <<TOML
model = {process = ["/usr/bin/python3", "truss.py"], name = "truss", parameters = {minimiser = "$minimiser", substep = $substep}}
grid = {origin = [-0.35, 0, -1.4], spacing = 0.35, counts = [3, 2, 9]}
TOML
  seed truss.toml --allow-process | expand --complete --allow-process truss.toml -o "truss.$minimiser.grid"
  if [[ $minimiser == leap ]]; then
    expect 3 "~.*snaps: steps along which the model snaps, and which end in another state when they are made in 64 pieces: C leaps over barriers.*.*" \
      '~check-model: broken: (.*, )?snaps .*' -- check-model truss.toml --allow-process --steps 120
    expect 3 "~.*snaps +[0-9]+ one-way links +[0-9]+  broken.*" '~verify: broken: (.*, )?snaps .*' -- \
      verify "truss.$minimiser.grid" --recompute 40 --allow-process truss.toml
  else
    expect 0 "~.*snaps +[1-9][0-9]* steps +0  note.*" '~check-model: fine: .*' -- check-model truss.toml --allow-process --steps 120
    expect 0 "~.*snaps +[1-9][0-9]* one-way links +0  note.*" '~verify: fine: .*' -- \
      verify "truss.$minimiser.grid" --recompute 40 --allow-process truss.toml
  fi
done
