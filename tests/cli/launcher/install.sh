# cmake --install puts the launcher on the PATH, the filters beside no coreutils, and manual pages.
source "$(dirname "$0")/../lib.sh"

DESTDIR=$PWD/root cmake --install "$HAPGRID_BUILD" >install.log || fail "$(cat install.log)"
prefix=$(dirname "$(dirname "$(find root -path '*/bin/hapgrid')")")
hapgrid=$prefix/bin/hapgrid
[[ $(ls "$prefix/bin") == hapgrid ]]

# It finds its filters, and they their plug-ins, wherever the tree was put.
moved=$'a $(touch x) `touch x` "b" \'c'
mv root "$moved"; hapgrid=$moved${hapgrid#root}
bin=$("$hapgrid" bin)
# Its lines for the shell lead to the filters, their pages and the Python module, from the build folder, too.
for launcher in "$hapgrid" "$HAPGRID_BUILD/bin/hapgrid"; do (
  eval "$("$launcher" env)"
  same 'what seed is' "$("$launcher" bin)/seed" "$(command -v seed)"
  [[ $MANPATH == *: && $(man -w hapgrid-seed) == "${MANPATH%:}"/man1/hapgrid-seed.1* ]] || fail "no page: MANPATH is $MANPATH"
  same 'the module' "$(readlink -f "$("$launcher" bin)/../python/hapgrid/__init__.py")" \
    "$(/usr/bin/python3 -c 'import hapgrid; print(hapgrid.__file__)')"
  same 'the grid to begin with' 'fine: 11 checks' "$(verify "$("$launcher" data)/hung-ball.grid" -o report 2>&1 | sed 's/^verify: //')"
); done
[[ ! -e x ]] || fail 'the lines of env execute a part of the path'
for tool in seed expand merge verify stats play view check-model; do
  expect 0 "hapgrid $tool 0.1.0" '' -- "$hapgrid" "$tool" -V
done
# The guard and the adapters are there as well.
handle=$("$hapgrid" play --list-devices | grep -o 'process:python3 .*/handle.py')
"$hapgrid" play --device "$handle" --duration 0.7 2>/dev/null | grep -q answers/s || fail "no $handle"
"$hapgrid" seed "$ball" | "$hapgrid" expand --complete -o installed.grid
seed "$ball" | expand --complete -o built.grid
cmp installed.grid built.grid
# The commands in Python have their parts there, too.
if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
  same "usage" 'Usage: hapgrid molecule (FILE | --smiles SMILES) -o DIR [OPTION...]' "$("$hapgrid" molecule --help | head -n 1)"
  same "usage" 'Usage: hapgrid table FILE -o DIR [OPTION...]' "$("$hapgrid" table --help | head -n 1)"
  same "usage" 'Usage: hapgrid dock HOST LIGAND -o DIR [OPTION...]' "$("$hapgrid" dock --help | head -n 1)"
fi
# In an environment of Python's its own Python starts them.
touch "$moved${prefix#root}/pyvenv.cfg"
printf '#!/bin/sh\necho "this Python: $4 $5"\n' >"$moved${prefix#root}/bin/python3"
chmod +x "$moved${prefix#root}/bin/python3"
same 'its Python' 'this Python: plot --help' "$("$hapgrid" plot --help)"
rm "$moved${prefix#root}"/{pyvenv.cfg,bin/python3}
# Through a link, as administrators make them.
ln -s "$PWD/$hapgrid" link
expect 0 "$bin" '' -- ./link bin
(PATH=/usr/bin:/bin; eval "$("$hapgrid" env)"; [[ $(command -v expand) == "$bin/expand" ]])

expect 2 '' "hapgrid: no tool 'exapnd'; did you mean expand or env? (see hapgrid --help)" -- "$hapgrid" exapnd
expect 2 '' "hapgrid: no tool '/../x' (see hapgrid --help)" -- "$hapgrid" /../x
same "help by name" 'CHECKS OF PLAY' "$("$hapgrid" help verify | grep 'OF PLAY')"
same "help" "$("$hapgrid" --help)" "$("$hapgrid" help)"
expect 2 '' 'hapgrid: which tool? (see hapgrid --help)' -- "$hapgrid"
expect 0 'hapgrid 0.1.0' '' -- "$hapgrid" --version
expect 0 'hapgrid 0.1.0' '' -- "$hapgrid" -V

# The manual pages are there; help.sh looks into them.
man=$moved${prefix#root}/share/man/man1
names=$(printf 'hapgrid-%s.1 ' check-model dock expand feel init merge molecule play plot rounds seed stats table verify view)
same 'the manual pages' "${names}hapgrid.1 " "$(ls "$man" | tr '\n' ' ')"
same 'the public headers' 'device.h plugin.h plugin.hpp ' "$(ls "$moved${prefix#root}/include/hapgrid" | tr '\n' ' ')"
# What the author of a plug-in or an adapter includes compiles, from the build folder and from the installation.
for include in "$HAPGRID_BUILD/include" "$moved${prefix#root}/include"; do
  printf '#include <hapgrid/%s>\n' plugin.h device.h | gcc -std=c11 -fsyntax-only -xc -I "$include" -
  printf '#include <hapgrid/plugin.hpp>\n' | g++ -std=c++20 -fsyntax-only -xc++ -I "$include" -
done
