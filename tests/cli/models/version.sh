# The version of a plug-in: its grid keeps it, and a plug-in of another version does not go on with the grid.
source "$(dirname "$0")/../lib.sh"

# build FOLDER LINE: the bead in C, with a line more in what it says of itself.
build() {
  mkdir "$1"
  sed "/info->force_scale = 1;/a $2" "$HAPGRID_SOURCE/examples/spring-c/spring.c" >"$1/spring.c"
  "${CC:-cc}" -shared -fPIC -I"$HAPGRID_BUILD/include" -o "$1/spring-c.so" "$1/spring.c" -lm
}
build first 'snprintf(info->version, sizeof info->version, "1.0");'
build second 'snprintf(info->version, sizeof info->version, "1.1");'
build unended 'memset(info->version, 0x76, sizeof info->version);'

define() {
  sed 's/^spacing.*/spacing = 5/; s/^counts.*/counts = [4, 3, 3]/' "$HAPGRID_SOURCE/examples/spring-c/spring-c.toml"
}
define >spring.toml
HAPGRID_MODEL_PATH=first seed spring.toml -o seeds
same 'the version in the header' 1.0 "$(header seeds modelVersion)"
HAPGRID_MODEL_PATH=first expand seeds -o requests
HAPGRID_MODEL_PATH=first merge seeds requests -o grid
differ="it and the grid differ in version '1\.1' and '1\.0'; was the plug-in changed since the grid was seeded\?"
HAPGRID_MODEL_PATH=second refuses "expand: model spring-c: $differ" -- expand seeds
HAPGRID_MODEL_PATH=second refuses "verify: model spring-c: $differ" -- verify grid
HAPGRID_MODEL_PATH=second seed spring.toml -o newer
HAPGRID_MODEL_PATH=second refuses "merge: requests: another grid than newer: version '1\.0' and '1\.1'" -- merge newer requests
# One that says none has none, and a text without an end is cut off.
seed spring.toml -o none
same 'no version' '' "$(header none modelVersion)"
refuses "expand: model spring-c: it and the grid differ in version '' and '1\.0'; was .*" -- expand seeds
HAPGRID_MODEL_PATH=unended seed spring.toml -o cut
same 'a version without an end' "$(printf 'v%.0s' {1..31})" "$(header cut modelVersion)"
