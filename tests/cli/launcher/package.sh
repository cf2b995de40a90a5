# The Debian package: what is in it works from wherever it is unpacked, and what cmake --install wrote goes again.
source "$(dirname "$0")/../lib.sh"
needs dpkg-shlibdeps dpkg-dev
cpack --config "$HAPGRID_BUILD/CPackConfig.cmake" -G DEB -B "$PWD/out" >cpack.log 2>&1 || fail "$(cat cpack.log)"
package=$(find out -maxdepth 1 -name 'hapgrid_0.1.0_*.deb')
dpkg-deb -f "$package" Depends | grep -q libhidapi-hidraw0 || fail "$(dpkg-deb -f "$package" Depends)"
dpkg-deb -f "$package" Recommends | grep -q 'xtb' || fail "$(dpkg-deb -f "$package" Recommends)"
dpkg-deb -x "$package" there
[[ $(ls there/usr/bin) == hapgrid ]] || fail "$(ls there/usr/bin)"
usr=$PWD/there/usr

PATH=$usr/bin:/usr/bin:/bin
unset HAPGRID_MODEL_PATH
hapgrid seed "$usr/share/doc/hapgrid/examples/hung-ball/hung-ball.toml" | hapgrid expand --complete -o grid
expect 0 '' 'verify: fine: 12 checks' -- hapgrid verify grid -o report
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
hapgrid seed "$usr/share/doc/hapgrid/examples/spring-c/spring-c.toml" --model-path models --set grid.spacing=0.5 \
  --set 'grid.counts=[3,2,2]' >/dev/null

# From a molecule to a verified grid and pictures, by what was unpacked alone. Hydrogen cyanide has no torsion.
molecule=(hapgrid molecule)
if "${molecule[@]}" --help >/dev/null 2>&1 && /usr/bin/python3 -c 'import ctypes
ctypes.CDLL("libxtb.so.6")' 2>/dev/null; then
  "${molecule[@]}" --smiles C#N -o cyanide --method gfnff --spacing 1.2 --quiet >line 2>said || fail "$(cat said)"
  grep -q '^hapgrid play cyanide/cyanide\.grid ' line || fail "$(cat line)"
  expect 0 '~.*' '~verify: fine: .*' -- hapgrid verify cyanide/cyanide.grid --recompute 20
  for file in index.html played.html force.png cyanide.toml; do [[ -s cyanide/$file ]] || fail "no $file"; done
else
  missing 'what hapgrid molecule needs'
fi
for page in init feel molecule; do
  [[ -s $(find there -name "hapgrid-$page.1*") || $page == molecule && ! -e $HAPGRID_BUILD/man/hapgrid-molecule.1 ]] ||
    fail "no manual page of $page"
done

# What the shell offers is what the help says.
bash -c 'source "$1"; COMP_WORDS=(hapgrid ve); COMP_CWORD=1; _hapgrid; echo "${COMPREPLY[@]}"
  COMP_WORDS=(hapgrid verify --re); COMP_CWORD=2; _hapgrid; echo "${COMPREPLY[@]}"
  COMP_WORDS=(hapgrid init --la); COMP_CWORD=2; _hapgrid; echo "${COMPREPLY[@]}"
  COMP_WORDS=(hapgrid feel --durat); COMP_CWORD=2; _hapgrid; echo "${COMPREPLY[@]}"' _ \
  "$usr/share/bash-completion/completions/hapgrid" >offered
same "offered" $'verify\n--recompute\n--lang\n--duration' "$(cat offered)"
# zsh and fish offer the same when the key is pressed.
if command -v fish >/dev/null; then
  same 'what fish offers' $'verify\n--recompute' "$(fish --no-config -c 'source $argv; complete -C "hapgrid veri"
    complete -C "hapgrid verify --reco"' "$usr/share/fish/vendor_completions.d/hapgrid.fish" | cut -f 1)"
else
  missing fish
fi
if command -v zsh >/dev/null; then
  cat >press.zsh <<'ZSH'
zmodload zsh/zpty
zpty z TERM=dumb zsh -f -i
zpty -w z "fpath=($1 \$fpath); autoload -U compinit; compinit -u -D; echo rea''dy"
zpty -r z out '*ready*'
zpty -n -w z $'hapgrid verify --reco\t'
zpty -r z out '*--recompute*'
zpty -n -w z $'\C-uhapgrid veri\t'
zpty -r z out '*verify*'
ZSH
  timeout 20 zsh -f press.zsh "$usr/share/zsh/vendor-completions" || fail 'zsh offers something else'
else
  missing zsh
fi
tools=(seed expand merge verify stats play view check-model feel init)
! "${molecule[@]}" --help >/dev/null 2>&1 || tools+=(molecule)
for tool in "${tools[@]}"; do
  hapgrid "${tool/feel/play}" --help | grep -oE -- '^  (-.,? ?([A-Z]+, )?)?--[a-z-]+' | grep -oE -- '--.*' | sort >known
  [[ -s known ]] || fail "no options of $tool"
  sed -n "s/^ *$tool) words='\(.*\)' ;;/\1/p" "$usr/share/bash-completion/completions/hapgrid" | tr ' ' '\n' | sort | diff - known ||
    fail "options of $tool"
done

DESTDIR=$PWD/root cmake --install "$HAPGRID_BUILD" >install.log
manifest=$HAPGRID_BUILD/install_manifest.txt
DESTDIR=$PWD/root cmake -D "MANIFEST=$manifest" -P "$HAPGRID_SOURCE/tools/package/uninstall.cmake" >/dev/null
[[ -z $(find root -type f -o -type l) ]] || fail "left: $(find root -type f)"
[[ -z $(find root -depth -path '*/hapgrid/*') ]] || fail "left: $(find root -path '*/hapgrid*')"
