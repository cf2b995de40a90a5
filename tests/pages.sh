#!/bin/bash
# The pages (*.md): every relative link leads to a file and to a heading in it, every path of this
# repository that a page names is there, each picture of the examples is on a page, and the README has
# at most 100 lines. Run with a directory, it looks at that one instead.
set -euo pipefail
cd "${1:-${HAPGRID_SOURCE:-$(dirname "$0")/..}}"

bad=0
linked=()
complain() {
  echo "$1" >&2
  bad=1
}

# The anchors of a page's headings, as GitHub makes them.
anchors() {
  grep -E '^#+ ' "$1" | sed -E 's/^#+ //; s/[^[:alnum:] _-]//g; s/ /-/g' | tr '[:upper:]' '[:lower:]'
}

mapfile -t pages < <(find . -name '*.md' -not -path './build*' -not -path './.*' | sort)
((${#pages[@]} > 0)) || complain "there are no pages"
for page in "${pages[@]}"; do
  while read -r link; do
    file=${link%%#*}
    target=$page
    [[ -z $file ]] || target=$(dirname "$page")/$file
    if [[ ! -e $target ]]; then
      complain "$page: the link $link leads nowhere"
    elif [[ $link == *#* ]] && ! anchors "$target" | grep -qxF -e "${link#*#}"; then
      complain "$page: the link $link names a heading that is not there"
    else
      linked+=("$(realpath "$target")")
    fi
  done < <(grep -oE '\]\([^)]*\)' "$page" | sed -E 's/^\]\(//; s/\)$//' | grep -vE '^[a-z]+:' || true)
  while read -r path; do
    [[ -e $path ]] || complain "$page: there is no $path"
  done < <(grep -oP '(?<![\w/.-])(libcore|tools|tests|examples|schemas)/[\w./-]*\w' "$page" || true)
done

all=$(printf '%s\n' "${linked[@]}")
while read -r picture; do
  grep -qxF "$(realpath "$picture")" <<<"$all" || complain "$picture is on no page"
done < <([[ ! -d examples ]] || find examples -name '*.png' -o -name '*.webp' -o -name '*.svg')

lines=$(wc -l <README.md)
((lines <= 100)) || complain "README.md has $lines lines, and may have 100"
exit $bad
