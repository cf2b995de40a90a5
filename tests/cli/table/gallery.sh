# examples/gallery: pages that play their grids, pictures and an index, which load nothing from elsewhere.
source "$(dirname "$0")/../lib.sh"
needs_python "jinja2, matplotlib" "python3-jinja2, python3-matplotlib"
eval "$(hapgrid env)"
expect 1 '' '~usage: gallery FOLDER|Makes a folder of pages .*' -- "$HAPGRID_SOURCE/examples/gallery" pages nonsense
"$HAPGRID_SOURCE/examples/gallery" pages orbital butane >said 2>err || fail "$(cat err)"
same "the last line" "~pages: 2 pages, [0-9.]+ MB" "$(tail -n 1 said)"
same "files" "butane.html butane.png index.html orbital.html orbital.png" "$(cd pages && echo *)"
same "links" "orbital.html butane.html" "$(grep -o 'href="[^"]*"' pages/index.html | cut -d'"' -f2 | xargs)"
grep -qE 'https?://' pages/index.html && fail "the index has an address"
grep -q '"torsions":\[\[' pages/butane.html || fail "no torsions"
