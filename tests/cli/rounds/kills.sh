# hapgrid rounds, with make as its launcher and alone in turns, killed with SIGKILL at KILLS random moments and started again: the
# same bytes in the end, and nothing is made twice but what was in flight. SEED draws other moments.
source "$(dirname "$0")/../lib.sh"
kills=${KILLS:-6}
RANDOM=${SEED:-1}
jobs=2

# Conversions that last, so that there is always something to kill.
cat >toy.toml <<'TOML'
model = {plugin = "toy", parameters = {amplitude = 0.2, milliseconds = 1}}
grid = {origin = [0, 0, 0], spacing = 1, counts = [4, 3, 2]}
TOML
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed toy.toml | expand --complete -j 32 -o reference

# The filters write down the files that they begin, which are known by -o and --part.
mkdir bin
ln -s "$HAPGRID_BIN"/* bin
rm bin/rounds
cp "$HAPGRID_BIN/rounds" bin  # a link would lead it to the filters themselves
for tool in expand merge; do
  rm bin/$tool
  cat >bin/$tool <<TOOL
#!/bin/bash
filter=("$HAPGRID_BIN/$tool" "\$@")
file=\$(sed 's/.* -o \([^ ]*\).*/\1/' <<<"\$*") part=\${!#}
file=\${file/'{}'/\${part/'/'/-of-}}
[[ \$* != *' -o '* || -e \$file ]] || echo "\$file" >>"$PWD/journal"
exec "\${filter[@]}"
TOOL
  chmod +x bin/$tool
done
drivers=("make -s -f $HAPGRID_SOURCE/Makefile.example grid MODEL=toy.toml HAPGRID_BIN=bin WORK=. PARTS=5 -j $jobs"
  "bin/rounds toy.toml --parts $jobs")

session=
trap '[[ ! $session ]] || pkill -KILL -s "$session" || true; rm -rf "$work"' EXIT
# kill_something: the ways take turns. The last one is any of them: a make, the driver, one of its steps, or a part.
kill_something() {
  local processes
  case $((killed % 3)) in
    0) pkill -KILL -s "$session" ;;
    1) pkill -KILL -s "$session" -x 'make|rounds' ;;
    2)
      mapfile -t processes < <(pgrep -s "$session")
      ((${#processes[@]})) || return 1  # all have ended; a division by 0 would leave the loop
      kill -KILL "${processes[RANDOM % ${#processes[@]}]}" 2>/dev/null
      ;;
  esac
}
killed=0 grids=0 again=0 starts=0
until ((killed >= kills && grids > 0)); do
  setsid ${drivers[starts++ % 2]} >out 2>err &
  session=$!
  while ((killed < kills)) && sleep "$(printf '0.%03d' $((RANDOM % 500)))" && kill_something; do
    killed=$((killed + 1))
  done
  wait $session 2>/dev/null && ended=0 || ended=$?
  while pgrep -s "$session" >/dev/null; do sleep 0.05; done  # what outlived its driver
  session=
  if ((ended == 0)); then
    cmp toy.grid reference
    nothing_left toy.rounds cost finished lock
    grids=$((grids + 1)) again=$((again + $(wc -l <journal) - $(sort -u journal | wc -l)))
    rm -r toy.grid toy.rounds journal
  fi
done
((killed >= kills && grids > 0)) || fail "$killed kills, $grids grids"
((again <= kills * jobs)) || fail "$again files were begun again after $kills kills of $jobs jobs"
echo "$kills kills, $grids grids, $again files begun again"
