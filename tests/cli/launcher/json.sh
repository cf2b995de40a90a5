# JSON of every tool that writes some is as its schema (schemas/*.schema.json) has it: all keys and no others.
source "$(dirname "$0")/../lib.sh"
needs_python jsonschema python3-jsonschema

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
HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins run 3 check-model.2 check-model broken.toml --steps 60 --format json
run 0 stats-grid.1 stats ball.grid --format json --cost cost
printf '%s\n' '-0.7 0.1 0' '-0.5 0.1 0' '-0.4 0 0' '-0.2 0 0' >path
run 0 play.1 play ball.grid --device path:path --rate 2000 --report - --frames frames --log a.session
run 0 play.2 play ball.grid --device path:path --traversal model --report -
run 0 stats-session.1 stats a.session --format json

/usr/bin/python3 - "$HAPGRID_SOURCE/schemas" <<'PYTHON'
import glob
import json
import sys

import jsonschema

# unit/check/passive_test.cpp has a grid of the first kind, and cli/play/process an adapter.
RARE = {"checks[].not_proved", "answers", "answers.p90_us", "answers.delay_ticks", "answers.declared_ticks"}


def listed(schema, whole, at=""):
    """The keys of a schema, as in "checks[].name"."""
    if "$ref" in schema:
        schema = whole["$defs"][schema["$ref"].split("/")[-1]]
    if "items" in schema:
        return listed(schema["items"], whole, at + "[]")
    return {at} - {""} | {key for name, inner in schema.get("properties", {}).items()
                          for key in listed(inner, whole, f"{at}.{name}" if at else name)}


def written(value, at=""):
    if isinstance(value, dict):
        return {at}.union(*(written(inner, f"{at}.{key}" if at else key) for key, inner in value.items()))
    if isinstance(value, list):
        return {at}.union(*(written(inner, at + "[]") for inner in value))
    return {at}


bad = []
names = sorted(glob.glob(sys.argv[1] + "/*.schema.json"))
assert len(names) == 5, names
for name in names:
    schema, what = json.load(open(name)), name.split("/")[-1].removesuffix(".schema.json")
    jsonschema.Draft202012Validator.check_schema(schema)
    found, reports = set(), glob.glob(what + ".[0-9]")
    assert reports, what
    for report in map(lambda file: json.load(open(file)), reports):
        bad += [f"{what}: {error.json_path}: {error.message}" for error in jsonschema.Draft202012Validator(schema).iter_errors(report)]
        found |= written(report)
    bad += [f"{name} lists {key}, which no {what} writes" for key in listed(schema, schema) - found - RARE]
sys.exit("\n".join(sorted(bad)) or 0)
PYTHON
