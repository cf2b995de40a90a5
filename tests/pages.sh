#!/bin/bash
# The pages (*.md): every relative link leads to a file and to a heading in it, every path of this
# repository that a page names is there, each picture of the examples is on a page, each option that a page or a
# manual page names is in the --help of its tool, and the README has at most 90 lines. Run with a directory, it
# looks at that one instead.
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

# The tool is the last one that the line names before the option, or else that of the manual page, or any.
/usr/bin/python3 - "${HAPGRID_BIN:-build/bin}/hapgrid" "${pages[@]}" tools/man/*.h2m <<'PYTHON' || bad=1
import re, subprocess, sys
hapgrid, *pages = sys.argv[1:]
tools = "seed expand merge rounds verify stats play view check-model plot feel init molecule table dock".split()
option = r"(?<![\w-])--[a-z][a-z-]*[a-z]"
others = set("""--array --build --cores --cpus-per-task --energy --error-exitcode --exclusive --exhaustiveness --ff --install --ligand
    --maps --no-install-recommends --num --out --prefix --sessions --preset --release --scoring --seed --system-site-packages --table --target --titration-state-method --wait --with-ph""".split())
has = {tool: set(re.findall(option, subprocess.run([hapgrid, tool, "--help"], capture_output=True, text=True).stdout)) for tool in tools}
has["feel"] |= has["view"] | {"--output"}
wrong = []
for page in pages:
    own = re.sub(r".*/hapgrid-|.*/|\.h2m", "", page)
    for number, line in enumerate(open(page, encoding="utf-8").read().replace(r"\-", "-").splitlines(), 1):
        for found in re.finditer(option, line):
            before = re.findall(rf"(?<![\w./-])(?:{'|'.join(tools)})(?![\w/-])", line[:found.start()])
            tool = before[-1] if before else own
            # Where modules are missing, a tool has no help.
            known = has.get(tool) or set().union(*has.values())
            if found[0] not in known | others | {"--help", "--version"} and "CHANGELOG" not in page:
                wrong.append(f"{page}:{number}: {tool if before else 'hapgrid'} has no option {found[0]}")
sys.exit("\n".join(wrong) or 0)
PYTHON

lines=$(wc -l <README.md)
((lines <= 90)) || complain "README.md has $lines lines, and may have 90"
exit $bad
