# No option is silently without effect: all pairs of the options of each filter. options.py has the table.
source "$(dirname "$0")/../lib.sh"
small() { sed -E 's/^origin = .*/origin = [-0.6, -0.25, -0.25]/; s/^spacing = .*/spacing = 0.25/; s/^counts = .*/counts = [6, 3, 3]/'; }
small <"$ball" >ball.toml
small <"$HAPGRID_SOURCE/examples/hung-ball/hung-ball-process.toml" >process.toml
cp "$HAPGRID_SOURCE/examples/hung-ball/hung_ball.py" .
echo '{"hapgrid": 1, "parameters": {}}' | PYTHONPATH=$HAPGRID_BIN/../python /usr/bin/python3 hung_ball.py >hello
echo 'cat hello; sleep 0.05' >slow.sh
sed 's/^process = .*/process = ["sh", "slow.sh"]/' process.toml >slow.toml
make_grid() { # NAME OPTION OF SEED -- OPTIONS OF EXPAND
  seed "$1.toml" ${2:+"$2"} -o "$1.seeds"
  expand --complete "$1.seeds" -o "$1.grid" "${@:4}"
}
make_grid ball '' --
make_grid process --allow-process -- --allow-process process.toml
expand --complete ball.seeds --cost cost -o again
rm again
for i in {-40..40}; do echo "$((i * 5))e-3 0.01 0.02"; done >path
tac path >back
printf '[play]\nscale = 3\nmax-force = 1.5\n' >play.toml
play ball.grid --device path:path --frames frames --log log.session 2>/dev/null
echo '0.1 0.2 0.1' | play ball.grid --device path:- --frames one.frames 2>/dev/null
/usr/bin/python3 "$here/options.py" "$@"
