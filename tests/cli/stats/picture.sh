# Pictures: PNG files of the promised kind, whole or not at all.
source "$(dirname "$0")/../lib.sh"
needs gnuplot gnuplot-nox

# png_size FILE: width and height of a whole PNG.
png_size() { /usr/bin/python3 "$here/../view/png.py" size "$1" || fail "$1 is no PNG, or cut off"; }

seed "$ball" -o seeds
expand --complete seeds -o grid
# 700 pixels for the longer side; margins of 110 + 245 and 75 + 80.
expect 0 '' '' -- stats grid --slice z=0 --png z.png
same "size" "1055 x 505" "$(png_size z.png)"
expect 0 '' '' -- stats --slice x=-0.1 --png x.png <grid
same "size" "1055 x 855" "$(png_size x.png)"
stats grid --slice y=0.475 --png - >y.png
same "size" "1055 x 505" "$(png_size y.png)"
expect 0 '' '' -- stats seeds --slice z=0.475 --png seeds.png
# Boxes of one plane or one row.
seed "$ball" --set 'grid.counts=[1,1,30]' | expand --complete -o line
for slice in x=-0.975 y=-0.475 z=0; do
  expect 0 '' '' -- stats line --slice $slice --png line.png
  png_size line.png >/dev/null
done

printf '# t\tx\ty\ts0\n0\t-1\t0\t0\n1\t0\t0\t0.5\n2\t0.5\t0\t0\n3\t-1\t0\t-0.5\n' >log
expect 0 '' '' -- stats --log log --plot x,s0 --png log.png
same "size" "1000 x 665" "$(png_size log.png)"
expect 0 '' '' -- stats --log - --plot t,x --labels "it's time,\`id\` \"α\" / rad" --png two.png <log
png_size two.png >/dev/null

# A force is drawn with the one that was sent: gnuplot gets four lines.
printf '# x\tforce_x\tsent_x\n0\t1\t0\n1\t1\t0.5\n0\t1\t1\n' >forces
mkdir spy
printf '#!/bin/sh\nexec tee "$SCRIPT" | PATH=%q gnuplot "$@"\n' "$PATH" >spy/gnuplot
chmod +x spy/gnuplot
for column in force_x sent_x; do
  SCRIPT=$PWD/script PATH=$PWD/spy:$PATH expect 0 '' '' -- stats --log forces --plot x,$column --png forces.png
  png_size forces.png >/dev/null
  same "lines" "there, from the model
back, from the model
there, as it was sent
back, as it was sent" "$(grep -o "title '[a-zHIP, ]*'" script | sed "s/title '//; s/'//")"
done

# The energy is drawn with the model's own, where the log has that.
printf '# x\tenergy\town_energy\n0\t1\t0\n1\t1\t0.5\n0\t1\t1\n' >energy-log
SCRIPT=$PWD/script PATH=$PWD/spy:$PATH expect 0 '' '' -- stats --log energy-log --plot x,energy --png energy.png
same "lines" "there, with the HIP
back, with the HIP
there, of the model alone
back, of the model alone" "$(grep -o "title '[a-zHIP, ]*'" script | sed "s/title '//; s/'//")"

# labels WORDS...: what the axes of the picture say that "stats WORDS --png" draws.
labels() {
  SCRIPT=$PWD/script PATH=$PWD/spy:$PATH expect 0 '' '' -- stats "$@" --png labels.png
  sed -nE "s/^set [xy]label '(.*)'$/\1/p" script
}
length="model''s unit of length"  # quotes are doubled in gnuplot's strings
# Each axis names its quantity and its unit: the grid's own where a grid is named.
same "a slice" $'y / rope lengths\nz / rope lengths' "$(labels grid --slice x=0)"
same "a log" "x of the HIP / $length"$'\nstate s0 / model\'\'s unit' "$(labels --log log --plot x,s0)"
same "a force" $'x of the HIP / rope lengths\nx of the force / N' "$(labels grid --log forces --plot x,sent_x)"
printf '# t\tenergy\n0\t-1\n1\t0\n' >energies
same "an energy" $'t / s\nenergy / N rope lengths' "$(labels grid --log energies --plot t,energy)"
same "its title" "energy over t, there and back" "$(sed -nE "s/^set label 1 '([^']*)'.*/\1/p" script)"
same "in words" $'a\nb' "$(labels grid --log energies --plot t,energy --labels a,b)"
molecule=$HAPGRID_SOURCE/examples/molecule/butane/butane.toml
seed "$molecule" -o butane
same "a molecule" $'x / Å\ny / Å' "$(labels butane --slice z=0)"
same "its energy" $'t / s\nenergy / (kJ/mol)' "$(labels butane --log energies --plot t,energy)"

# Refused: no picture is left, and an old one stays as it was.
mkdir empty
refuses 'stats: slice z=0.6 is outside the box: z goes from -0.475 to 0.475' -- \
  stats grid --slice z=0.6 --png empty/z.png
printf '# t\tx\ty\ts0\n0\t-1\t0\tup\n' >word
refuses "stats: word: line 2: column s0: 'up' is no finite number" -- \
  stats --log word --plot x,s0 --png empty/log.png
refuses "stats: log: line 1: no column 's1' in: t x y s0" -- \
  stats --log log --plot x,s1 --png empty/log.png
refuses 'stats: none: No such file or directory' -- \
  stats --log none --plot x,s1 --png empty/log.png
# A PATH without gnuplot, then with one that fails halfway.
mkdir tools
ln -s "$HAPGRID_BIN/stats" tools/
refuses 'stats: gnuplot: not found: install gnuplot-nox' -- \
  env PATH="$PWD/tools" stats grid --slice z=0 --png empty/z.png
printf '#!/bin/sh\necho half a picture\nexec /bin/sh -c "echo; echo no fonts >&2; exit 1"\n' \
  >tools/gnuplot
chmod +x tools/gnuplot
cp z.png old.png
refuses 'stats: gnuplot: no fonts' -- env PATH="$PWD/tools" stats grid --slice x=0 --png old.png
cmp z.png old.png
refuses 'stats: gnuplot: no fonts' -- env PATH="$PWD/tools" stats grid --slice x=0 --png empty/x.png
nothing_left empty

see='\(see stats --help\)'
expect 2 '' "~stats: --slice needs --png $see" -- stats grid --slice z=0
expect 2 '' "~stats: --png needs --slice or --log $see" -- stats grid --png z.png
expect 2 '' "~stats: --plot needs --log $see" -- stats grid --plot x,s0
expect 2 '' "~stats: --labels needs --plot $see" -- stats --log log --labels x,s0 --png z.png
expect 2 '' "~stats: --log: a log that is text needs --plot and --png $see" -- \
  stats --log log --png z.png
expect 2 '' "~stats: --log: a log that is text needs --plot and --png $see" -- \
  stats --log log --plot x,s0
expect 2 '' "~stats: --log reads a recorded play, so no grid can be given, except with --plot for its units $see" -- \
  stats grid --log log
refuses 'stats: none: No such file or directory' -- stats none --log log --plot x,s0 --png empty/z.png
for slice in w=0 z z= z=up z=nan z=0,5 'z =0'; do
  expect 2 '' "~stats: --slice: '$slice' is not like z=0\.25 $see" -- \
    stats grid --slice "$slice" --png z.png
done
expect 2 '' "~stats: --plot: 'x' is not two texts with a comma between $see" -- \
  stats --log log --plot x --png z.png
