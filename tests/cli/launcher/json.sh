# JSON of every tool that writes some has the keys that its manual page lists, all of them and no others, and a version.
source "$(dirname "$0")/../lib.sh"

stored=(--set grid.spacing=0.15 --set 'grid.counts=[14,4,2]' --set 'grid.origin=[-0.975,-0.225,-0.075]')
seed "$ball" "${stored[@]}" --set model.parameters.stored=true | expand --complete --cost cost -o ball.grid
python3 - "$HAPGRID_SOURCE/tests/cli/verify" ball.grid links.grid <<'PYTHON'
import sys
sys.path.insert(0, sys.argv[1])
import planting
grid = planting.Grid(open(sys.argv[2], "rb").read())
row = next(row for row in grid.rows if row["links"][planting.X] == 0)
row["links"][planting.X] = 254  # not settled
open(sys.argv[3], "wb").write(grid.seal())
PYTHON
run() {  # CODE FILE COMMAND...: its standard output
  local code=0
  "${@:3}" >"$2" 2>err || code=$?
  [[ $code == "$1" ]] || fail "${*:3}: exit code $code: $(cat err)"
}
run 0 verify.1 verify ball.grid --format json
run 3 verify.2 verify links.grid --format json --recompute none
run 0 check-model.1 check-model "$ball" --format json --steps 200
cat >broken.toml <<TOML
model = {plugin = "puppet", parameters = {component = 1, above = 1}}
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [3, 3, 3]}
TOML
run 3 check-model.2 check-model broken.toml --model-path "$HAPGRID_BUILD/tests/plugins" --steps 60 --format json
run 0 stats-grid.1 stats ball.grid --format json --cost cost
printf '%s\n' '-0.7 0.1 0' '-0.5 0.1 0' '-0.4 0 0' '-0.2 0 0' >path
run 0 play.1 play ball.grid --device path:path --rate 2000 --report - --frames frames --log a.session
run 0 play.2 play ball.grid --device path:path --traversal model --report -
run 0 stats-session.1 stats --log a.session --format json

python3 - "$HAPGRID_SOURCE/tools/man" <<'PYTHON'
import glob
import json
import re
import sys

PAGES = {"verify": "verify|THE REPORT AS JSON", "check-model": "check-model|THE REPORT AS JSON",
         "stats-grid": "stats|THE REPORT ON A GRID AS JSON", "stats-session": "stats|THE REPORT ON A SESSION AS JSON",
         "play": "play|THE REPORT AS JSON"}


def paths(value, at=""):
    if isinstance(value, dict) and value:
        return set().union(*(paths(v, f"{at}.{k}" if at else k) for k, v in value.items()))
    if isinstance(value, list) and value:
        return set().union(*(paths(v, at + "[]") for v in value))
    return {at}


# unit/check/passive_test.cpp has a grid of the first kind, and cli/play/process an adapter.
RARE = {"checks[].not_proved", "answers.p90_us", "answers.delay_ticks", "answers.declared_ticks"}

bad = []
for what, where in PAGES.items():
    page, section = where.split("|")
    text = open(f"{sys.argv[1]}/{page}.h2m").read().replace("\\-", "-")
    table = text.split(f"[{section}]\n")[1].split(".nf\n")[1].split("\n.fi")[0]
    listed = {line.split()[0] for line in table.splitlines()}
    wild = {key: re.compile(re.sub("NAME|KEY", ".+", re.escape(key))) for key in listed}
    written, files = set(), glob.glob(what + ".[0-9]")
    assert files, what
    for name in files:
        report = json.load(open(name))
        assert report["version"] == 1, name
        written |= paths(report)
    used = set()
    for key in written:
        found = {k for k, expression in wild.items() if expression.fullmatch(key)}
        used |= found
        # What is null or empty here can be an object or a list elsewhere.
        if not found and not any(k.startswith((key + ".", key + "[")) for k in listed):
            bad.append(f"{what} writes {key}, which hapgrid-{page}(1) does not list")
    bad += [f"hapgrid-{page}(1) lists {key}, which no {what} writes" for key in listed - used - RARE]
sys.exit("\n".join(sorted(bad)) or 0)
PYTHON
