# Makefile.example's grid, killed with SIGKILL at KILLS random moments and started again: the same
# bytes in the end, and nothing is made twice but what was in flight. SEED draws other moments.
source "$(dirname "$0")/../lib.sh"
kills=${KILLS:-6}
RANDOM=${SEED:-1}
jobs=2

# Conversions that last, so that there is always something to kill.
cat >toy.toml <<'TOML'
model = {plugin = "toy", parameters = {amplitude = 0.3, milliseconds = 1}}
grid = {origin = [0, 0, 0], spacing = 1, counts = [4, 3, 3]}
TOML
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed toy.toml | expand --complete -j 32 -o reference

# The filters write down what they begin, which is known by -o.
mkdir bin
ln -s "$HAPGRID_BIN"/* bin
for tool in expand merge; do
  rm bin/$tool
  cat >bin/$tool <<TOOL
#!/bin/bash
filter=("$HAPGRID_BIN/$tool" "\$@")
while [[ \$1 != -o ]]; do shift; done
echo "\$2" >>"$PWD/journal"
exec "\${filter[@]}"
TOOL
  chmod +x bin/$tool
done
driver=(setsid make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL=toy.toml
  HAPGRID_BIN=bin PARTS=5 -j "$jobs")

session=
trap '[[ ! $session ]] || pkill -KILL -s "$session" || true; rm -rf "$work"' EXIT
# kill_something: the ways take turns. One of the processes is the recipe, a make of a round or a filter.
kill_something() {
  local processes
  case $((killed % 3)) in
    0) pkill -KILL -s "$session" ;;
    1) pkill -KILL -s "$session" -x make ;;
    2)
      mapfile -t processes < <(pgrep -s "$session")
      ((${#processes[@]})) || return 1  # all have ended; a division by 0 would leave the loop
      kill -KILL "${processes[RANDOM % ${#processes[@]}]}" 2>/dev/null
      ;;
  esac
}
killed=0 grids=0 again=0
until ((killed >= kills && grids > 0)); do
  "${driver[@]}" >make.out 2>make.err &
  session=$!
  while ((killed < kills)) && sleep "$(printf '0.%03d' $((RANDOM % 500)))" && kill_something; do
    killed=$((killed + 1))
  done
  wait $session 2>/dev/null && ended=0 || ended=$?
  while pgrep -s "$session" >/dev/null; do sleep 0.05; done  # what outlived its make
  session=
  if ((ended == 0)); then
    cmp work/toy.grid reference
    nothing_left work toy toy.cost toy.grid
    grids=$((grids + 1)) again=$((again + $(wc -l <journal) - $(sort -u journal | wc -l)))
    rm -r work journal
  fi
done
((killed >= kills && grids > 0)) || fail "$killed kills, $grids grids"
((again <= kills * jobs)) || fail "$again files were begun again after $kills kills of $jobs jobs"
echo "$kills kills, $grids grids, $again files begun again"
