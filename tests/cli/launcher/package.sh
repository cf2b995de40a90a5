# The Debian package: what is in it works from wherever it is unpacked.
source "$(dirname "$0")/../lib.sh"
needs dpkg-shlibdeps dpkg-dev
# zstd packs faster than the usual gzip.
cpack --config "$HAPGRID_BUILD/CPackConfig.cmake" -G DEB -D CPACK_DEBIAN_COMPRESSION_TYPE=zstd -B "$PWD/out" >cpack.log 2>&1 || fail "$(cat cpack.log)"
package=$(find out -maxdepth 1 -name 'hapgrid_0.1.0_*.deb')
dpkg-deb -f "$package" Depends | grep -q libhidapi-hidraw0 || fail "$(dpkg-deb -f "$package" Depends)"
dpkg-deb -f "$package" Recommends | grep -q 'xtb' || fail "$(dpkg-deb -f "$package" Recommends)"
dpkg-deb -x "$package" there
[[ $(ls there/usr/bin) == hapgrid ]] || fail "$(ls there/usr/bin)"
usr=$PWD/there/usr

PATH=$usr/bin:/usr/bin:/bin
unset HAPGRID_MODEL_PATH HAPGRID_BIN  # the filters beside the launcher, not those of the build
hapgrid seed "$usr/share/doc/hapgrid/examples/hung-ball/hung-ball.toml" | hapgrid expand --complete -o grid
expect 0 '' 'verify: fine: 11 checks' -- hapgrid verify grid -o report
hapgrid play grid --device "path:$usr/share/doc/hapgrid/examples/hung-ball/path-there-and-back.txt" --log log 2>/dev/null

# The module for Python is where Debian's python3 looks for it, and reads the grid with the program beside it.
PYTHONPATH=$usr/lib/python3/dist-packages /usr/bin/python3 -c '
import hapgrid, sys
assert len(hapgrid.read("grid")["level"]) == int(sys.argv[1])' "$(hapgrid stats --get records grid)"

# Who writes a plug-in finds the headers by pkg-config and by CMake.
config=$(dirname "$(find "$usr" -name hapgrid.pc)")
cp "$usr/share/doc/hapgrid/examples/spring-c/spring.c" .
mkdir models
# shellcheck disable=SC2046  # words
cc -std=c11 -shared -fPIC $(PKG_CONFIG_PATH=$config pkg-config --cflags hapgrid) spring.c -o models/spring-c.so -lm
cat >CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(mine C)
find_package(hapgrid 0.1 REQUIRED)
add_library(spring MODULE spring.c)
target_link_libraries(spring hapgrid::plugin m)
message(STATUS "models: ${hapgrid_MODELS}")
CMAKE
cmake -B mine -D CMAKE_PREFIX_PATH="$usr" . >mine.log && cmake --build mine >>mine.log 2>&1 || fail "$(cat mine.log)"
grep -q "models: $(dirname "$(find "$usr" -name hung-ball.so)")\$" mine.log || fail "$(cat mine.log)"
HAPGRID_MODEL_PATH=models hapgrid seed "$usr/share/doc/hapgrid/examples/spring-c/spring-c.toml" --set grid.spacing=0.5 \
  --set 'grid.counts=[3,2,2]' >/dev/null

# From a molecule to a verified grid and pictures, by what was unpacked alone. Hydrogen cyanide has no torsion.
molecule=(hapgrid molecule)
if "${molecule[@]}" --help >/dev/null 2>&1 && /usr/bin/python3 -c 'import ctypes
ctypes.CDLL("libxtb.so.6")' 2>/dev/null; then
  "${molecule[@]}" --smiles C#N -o cyanide --method gfnff --spacing 1.2 --quiet >line 2>said || fail "$(cat said)"
  grep -q '^NOTHING TURNS ' line && grep -q '^hapgrid feel cyanide/cyanide\.grid$' line || fail "$(cat line)"
  expect 0 '~.*' '~verify: fine: .*' -- hapgrid verify cyanide/cyanide.grid --recompute 20
  for file in index.html played.html cyanide.toml; do [[ -s cyanide/$file ]] || fail "no $file"; done
else
  missing 'what hapgrid molecule needs'
fi
for page in init feel molecule; do
  [[ -s $(find there -name "hapgrid-$page.1*") || $page == molecule && ! -e $HAPGRID_BUILD/man/man1/hapgrid-molecule.1 ]] ||
    fail "no manual page of $page"
done
