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
any='(.|'$'\n'')*'
finds none 0 "${any}returns +60 conversions +0  note${any}spread 0: 99 % of the states that count as the same are this near; the tolerance is 1e-06$any" \
  'check-model: fine: 10 checks'
# What is said first is what matters most.
finds 'no force' 0 "check +counted +offenders +verdict"$'\n'"felt +1 models +1  note"$'\n'"${any}"$'\n\n'"felt: a model without a force: nothing of its grid can be felt.*"$'\n'"$any" \
  'check-model: fine: [0-9]+ checks, but nothing can be felt'
finds zero 0 "${any}felt: the largest of [0-9]+ forces is 0 N, which nobody feels: .*$any" 'check-model: fine: [0-9]+ checks, but nothing can be felt'
finds leak 0 "${any}memory: the model's memory grows as long as it is asked, by [0-9.]+ .*B in [0-9]+ steps$any" "check-model: fine: 10 checks, but the model's memory grows"
finds wide 0 "${any}spread: states that count as the same are up to 0\.001 apart, more than a tenth of the tolerance, 0\.005$any" \
  'check-model: fine: .*, but the tolerance is too wide, or C not exact: .*'
finds axis 3 "${any}along x the force is 0\.97 times the energy's negative gradient$any" 'check-model: broken: gradient .*'
finds 'no scale' 3 "${any}gradient: force_scale is 0: it says how many newtons one unit of energy per unit of length is, here 1"$'\n'"$any" \
  'check-model: broken: gradient .*'
finds sign 3 "${any}gradient: the sign of the force is wrong: it points up the energy"$'\n'"$any" 'check-model: broken: gradient .*'
finds thousand 3 "${any}gradient: the force is 1,000 times the energy's negative gradient: is its unit right, or should force_scale be 1000\?"$'\n'"$any" \
  'check-model: broken: gradient .*'
finds strong 0 "${any}strong: forces beyond 100 N, which no device sends: is force_scale right, and the force in newtons\?"$'\n'"$any" \
  'check-model: fine: .*'
finds 'one of three' 3 "${any}force\(\) returned \[[-0-9.]+, nan, -0.0\]$any" 'check-model: broken: defined .*'
finds edge 3 "${any}RuntimeError: the mesh is inverted \(mistaken\.py, line [0-9]+\)$any" 'check-model: broken: defined .*'
# A step that failed is no other state.
grep -qE '^returns .* 0  note$' "$work/got/out" || fail 'a step back that failed is another state'
# Last bits are a note, with their size; more than that is a fault, with the component.
finds 'last bits' 0 "${any}deterministic +120 conversions +[0-9]+  note$any"$'\n'"deterministic: C, asked again, answers with other last bits, which differ by up to [0-9.e-]+\. That is far below the tolerance, 1e-06;$any" \
  'check-model: fine: .*'
finds history 3 "${any}, component 0 differs most, by 0\.0001"$'\n'"$any" 'check-model: broken: deterministic .*'
finds damped 3 "${any}stays: .*"$'\n'"$any, component 0 differs most, by [0-9.e-]+"$'\n'"$any" 'check-model: broken: .*stays.*'
finds halves 3 "${any}halves: .*$any" 'check-model: broken: (.*, )?halves .*'
finds top 3 "${any}stable +60 states +60  broken$any" 'check-model: broken: stable \(60 of 60\)'
grep -qE 'falls to [(]?-?[0-9.]+, -?1[)]? and to [(]?-?[0-9.]+, -?1[)]?$' "$work/got/out" || fail 'not where it falls to'
seed mistaken.toml --allow-process | expand --complete --allow-process mistaken.toml -o top.grid
expect 3 "~${any}stable +81 records +81  broken$any" '~verify: broken: stable \(81 of 81\)' -- verify top.grid --allow-process mistaken.toml

# What a model takes to start is no conversion, and its time is not that of the walks.
define loads >loads.toml
expect 0 "~${any}start +[2-9][0-9.]* s"$'\n'"conversion +median [0-9.]+ (µs|ms), .*$any.* on one core$any" '~check-model: fine: 10 checks' -- \
  check-model loads.toml --allow-process --steps 60 --seconds 1.5
# Two conversions tell nothing of the others.
define slow >slow.toml
expect 0 "~${any}whole grid +no estimate, because too few steps: [0-9] conversions? tells? nothing of the others\. .*$any" '~check-model: fine: .*' -- \
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
expect 3 "~${any}among: C answers otherwise when it is asked several questions at a time: a row of convert_many\(\) depends on the others.*$any, by [0-9.]+e-[0-9]+"$'\n'"$any" \
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
    expect 3 "~${any}snaps: steps along which the model snaps, and which end in another state when they are made in 64 pieces: C leaps over barriers.*$any" \
      '~check-model: broken: (.*, )?snaps .*' -- check-model truss.toml --allow-process --steps 120
    expect 3 "~${any}snaps +[0-9]+ one-way links +[0-9]+  broken$any" '~verify: broken: (.*, )?snaps .*' -- \
      verify "truss.$minimiser.grid" --recompute 40 --allow-process truss.toml
  else
    expect 0 "~${any}snaps +[1-9][0-9]* steps +0  note$any" '~check-model: fine: .*' -- check-model truss.toml --allow-process --steps 120
    expect 0 "~${any}snaps +[1-9][0-9]* one-way links +0  note$any" '~verify: fine: .*' -- \
      verify "truss.$minimiser.grid" --recompute 40 --allow-process truss.toml
  fi
done
