# The help of each tool is short enough to read, and its manual page has what a reader looks for.
source "$(dirname "$0")/../lib.sh"
export LC_ALL=C.UTF-8

tools=(hapgrid feel init seed expand merge rounds verify stats play view plot check-model molecule table dock)
molecule() { hapgrid molecule "$@"; }
table() { hapgrid table "$@"; }
dock() { hapgrid dock "$@"; }
rounds() { hapgrid rounds "$@"; }
for tool in "${tools[@]}"; do
  lines=85 page=hapgrid-$tool
  [[ $tool != play ]] || lines=130
  [[ $tool != molecule ]] || lines=110
  [[ $tool != hapgrid ]] || page=hapgrid
  "$tool" --help >help
  (($(wc -L <help) <= 80)) || fail "$tool --help is $(wc -L <help) columns wide"
  (($(wc -l <help) <= lines)) || fail "$tool --help has $(wc -l <help) lines"
  # None of CLI11's own notes on types and options is left.
  ! grep -E ':(INT|FLOAT|TEXT|POSITIVE|\{)|Needs:|Excludes:|REQUIRED|\{auto\}' help || fail "$tool --help shows how it is parsed"
  [[ $tool =~ ^(feel|init)$ ]] || for code in 'Exit codes:' '  0  done' '  1  could not' '  2  the command line is wrong'; do
    grep -q "^$code" help || fail "$tool --help does not say: $code"
  done

  man=$HAPGRID_BUILD/man/man1/$page.1
  grep -q "^\.TH ${page^^} \"1\" " "$man" || fail "the title of $man: $(grep '^\.TH' "$man")"
  same "name in $man" "~$page "'\\- [a-z].*' "$(sed -n '/^\.SH NAME/{n;p}' "$man")"
  grep -q '^\.SH EXAMPLES' "$man" || fail "$man has no EXAMPLES"
  # What `hapgrid help` makes of it without man: each heading, nothing of the format, and 79 columns.
  hapgrid help "$tool" >text
  sed -nE 's/^\.S[HS] "?([^"]*)"?$/\1/p' "$man" >headings
  cmp headings <(grep -Fxf headings text) || fail "hapgrid help $tool lacks headings"
  ! grep -E '\\|^ *\.[A-Z]' text || fail "hapgrid help $tool has roff"
  ! grep -E "^ .*hapgrid $tool .*hapgrid $tool " text || fail "hapgrid help $tool has two examples on a line"
  (($(wc -L <text) < 80)) || fail "hapgrid help $tool is $(wc -L <text) columns wide"
  # SEE ALSO names pages that there are.
  sed -n '/^\.SH "SEE ALSO"/,/^\.SH/p' "$man" | grep -oE 'hapgrid[a-z-]*' >others || fail "$man has no SEE ALSO"
  while read -r other; do
    [[ -e $HAPGRID_BUILD/man/man1/$other.1 ]] || fail "$man: there is no page $other"
  done <others
done
