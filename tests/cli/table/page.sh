# The page of `hapgrid table` on a telephone is as wide as the screen. Only the report in it scrolls sideways.
source "$(dirname "$0")/../lib.sh"
needs chromium chromium
needs_python "jinja2, matplotlib" "python3-jinja2, python3-matplotlib"

printf '%s\n' 'GRID_PARAMETER_FILE x' 'GRID_DATA_FILE x' 'MACROMOLECULE x' 'SPACING 0.5' 'NELEMENTS 4 4 4' \
  'CENTER 1 2 3' >good.map
for ((n = 0; n < 125; ++n)); do echo $((n * n % 31)); done >>good.map
hapgrid table good.map -o good -q >/dev/null
in_time words /usr/bin/python3 "$here/page.py" "file://$PWD/good/index.html" 2> >(tee words >&2)
