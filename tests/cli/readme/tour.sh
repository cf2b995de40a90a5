# The README's tour of the pipeline, line by line as a reader would type it.
source "$(dirname "$0")/../lib.sh"

tour=$(sed -n '/^```sh$/,/^```$/p' "$HAPGRID_SOURCE/README.md" | sed '1d;$d')
[[ $(wc -l <<<"$tour") -eq 10 ]] || fail "the tour has no ten lines"
ln -s "$HAPGRID_SOURCE/examples" "$HAPGRID_SOURCE/schemas" .
mkdir build
ln -s "$HAPGRID_BIN" build/bin
bash -euo pipefail <<<"${tour//| less/> decoded}" >out 2>err || fail "the tour failed: $(cat err)"

seed examples/hung-ball/hung-ball.toml | expand --complete -o whole
cmp ball.grid whole
grep -q 'verify: fine' err
[[ $(head -c 4 levels.png | tail -c 3) == PNG ]]
[[ $(wc -l <ball.log) -eq 1802 ]]  # a line a tick and the names of the columns
grep -q 'stateSize = 1' decoded
