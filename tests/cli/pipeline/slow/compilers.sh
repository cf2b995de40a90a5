# g++ and clang build filters that write the same bytes, and models, too, whose arithmetic is IEEE's basic
# operations in the order in which they are written, and functions of the same mathematical library.
source "$(dirname "$0")/../../lib.sh"

used=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "$HAPGRID_BUILD/CMakeCache.txt")
if "$used" --version | grep -q clang; then other=(gcc g++); else other=(clang clang++); fi
command -v "${other[@]}" >/dev/null || skip "no ${other[1]} is installed"
sanitized && skip "sanitizers"
build=${HAPGRID_OTHER_BUILD:-$work/build}  # a build that is there already saves minutes
cmake -S "$HAPGRID_SOURCE" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=ON \
  -DCMAKE_C_COMPILER="${other[0]}" -DCMAKE_CXX_COMPILER="${other[1]}" >cmake.log || fail "$(tail cmake.log)"
cmake --build "$build" --target seed expand merge test_plugin_toy hung-ball molecule >build.log ||
  fail "$(tail build.log)"

for size in 1 3; do
  cat >$size.toml <<TOML
model = {plugin = "toy", parameters = {state_size = $size, amplitude = 0.3}}
grid = {origin = [-0.375, 0, 0.0625], spacing = 0.1, counts = [6, 5, 4]}
search = {max_levels = 100}
TOML
done
sed 's/^counts = .*/counts = [20, 10, 10]/; s/^spacing = .*/spacing = 0.1/; /^.model.parameters.$/a stored = true' "$ball" >ball.toml
# This one has functions for processors with AVX2, too, where g++ compiles it.
dipeptide=$HAPGRID_SOURCE/examples/molecule/alanine-dipeptide
cp "$dipeptide"/*.xyz .
sed 's/^counts = .*/counts = [12, 12, 12]/; s/^spacing = .*/spacing = 1.3/' "$dipeptide/alanine-dipeptide.toml" >dipeptide.toml
search() { # FILTERS MODELS FOLDER: all that a search writes
  local PATH=$1/bin:$PATH
  export HAPGRID_MODEL_PATH=$2/tests/plugins:$2/models
  mkdir -p "$3"
  for model in 1 3 ball dipeptide; do
    seed $model.toml -o "$3/$model.0"
    for ((g = 0; g < 3; ++g)); do
      expand "$3/$model.$g" --part 1/2 -o "$3/$model.$g.1"
      expand "$3/$model.$g" --part 2/2 -j 2 -o "$3/$model.$g.2"
      merge "$3/$model.$g" "$3/$model.$g".[12] -o "$3/$model.$((g + 1))"
    done
    expand --complete "$3/$model.$g" -o "$3/$model.grid"
    merge --small "$3/$model.grid" -o "$3/$model.small"
  done
}
search "$HAPGRID_BUILD" "$HAPGRID_BUILD" ours
for pair in "$build $build" "$build $HAPGRID_BUILD" "$HAPGRID_BUILD $build"; do
  rm -rf theirs
  # shellcheck disable=SC2086  # two words
  search $pair theirs
  for file in ours/*; do
    cmp "$file" "theirs/${file#ours/}" || fail "filters and models of $pair"
  done
done
(($(stats ours/3.grid --get records) > 300 && $(stats ours/ball.grid --get records) > 2000)) || fail "a small grid"
