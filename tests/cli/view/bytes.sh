# A picture has the same pixels everywhere: those of the build, whatever its compiler and flags, and those of g++ without
# any optimisation. No product and sum become one operation, so that each is rounded as IEEE 754 says.
source "$(dirname "$0")/../lib.sh"
core=$HAPGRID_SOURCE/libcore
read -ra letters < <(pkg-config --cflags freetype2)
# In one piece, since g++ takes longest for the headers.
printf '#include "%s"\n' "$core"/base/{file,format,text}.cpp "$core/grid/box.cpp" \
  "$core"/scene/{drawing,legend,letters,render,scene}.cpp "$here/bytes.cpp" >plain.cpp
g++ -std=c++20 -O0 -w -ffp-contract=off -I"$HAPGRID_SOURCE" "${letters[@]}" plain.cpp -lfmt -lfreetype -lpng -lutf8proc -o plain
./plain >plain.pixels
"$HAPGRID_BUILD/tests/picture_bytes" >pixels
same "bytes" $((2 * 3 * 320 * 240)) "$(stat -c %s pixels)"
cmp pixels plain.pixels
