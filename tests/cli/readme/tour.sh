# The commands of the README, and those of the guide's page about the pipeline, line by line as a reader would type them.
source "$(dirname "$0")/../lib.sh"
needs_python matplotlib python3-matplotlib

# commands PAGE: what stands in its block of shell commands.
commands() { sed -n '/^```sh$/,/^```$/p' "$HAPGRID_SOURCE/$1" | sed '1d;$d'; }
ln -s "$HAPGRID_SOURCE/examples" "$HAPGRID_SOURCE/schemas" .
mkdir build
ln -s "$HAPGRID_BIN" build/bin

own=$(commands README.md | grep -v "^make -f Makefile.example build$")  # tests/fresh.sh does this
[[ $(wc -l <<<"$own") -eq 3 ]] || fail "the README's commands for a model of one's own are not three"
# The same in C, which takes a tenth of the time; cli/launcher/init has all languages.
bash -euo pipefail <<<"${own/--lang python/--lang c}" >out 2>err || fail "the README's commands failed: $(cat err)"
expect 0 0 '' -- stats --get frontier mymodel/mymodel.grid

tour=$(commands examples/guide/pipeline.md)
[[ $(wc -l <<<"$tour") -eq 10 ]] || fail "the tour has no ten lines"
bash -euo pipefail <<<"${tour//| less/> decoded}" >out 2>err || fail "the tour failed: $(cat err)"

seed examples/hung-ball/hung-ball.toml | expand --complete -o whole
cmp ball.grid whole
grep -q 'verify: fine' err
[[ $(head -c 4 levels.png | tail -c 3) == PNG ]]
[[ $(wc -l <ball.log) -eq 1802 ]]  # a line a tick and the names of the columns
grep -q 'stateSize = 1' decoded
