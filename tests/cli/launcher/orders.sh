# An option that can be given several times takes one value each time, so that the file behind it is read;
# a filter that reads a terminal says so.
source "$(dirname "$0")/../lib.sh"

echo 0 0 0 >path
found=
for tool in seed expand merge verify stats play view check-model molecule-check; do
  more=()
  [[ $tool != play ]] || more=(--device path:path)
  $tool --help >help
  # Of the help's options, those whose text says so. A text can go on in further lines.
  for option in $(sed -E ':a; N; $!ba; s/\n {20,}/ /g' help | sed -nE 's/^  (-., )?(--[a-z-]+).* given several times.*/\2/p' | sort -u); do
    case $option in
      --set) value=grid.spacing=1 ;;
      --cost) value=path ;;
      *) value=. ;;
    esac
    found+=" $tool$option"
    missing="$tool: no-such: No such file or directory"
    [[ $tool != stats ]] || missing="stats: (no-such: No such file or directory|path: .*)"
    refuses "$missing" -- $tool $option $value no-such "${more[@]}" </dev/null
    refuses "$missing" -- $tool no-such $option $value "${more[@]}" </dev/null
    refuses "$missing" -- $tool $option $value $option $value no-such "${more[@]}" </dev/null
  done
done
same "options that can be repeated" " seed--set stats--cost check-model--set" "$found"
# Numbers with commas between them are one value.
for order in "--xyz 0.5,0,0,1 no-such" "no-such --xyz 0.5,0,0,1"; do
  refuses "molecule-check: no-such: No such file or directory" -- molecule-check $order
done

seed "$ball" --set 'grid.counts=[4,3,2]' -o g
for command in "seed -" expand "expand --complete" merge "merge -" verify stats view \
  "play - --device path:path" "check-model -" "stats g --cost -" "verify /dev/stdin" "expand /dev/stdin" \
  "merge g /dev/tty" "molecule-check -" "play g --device path:/dev/stdin" "view /dev/tty"; do
  script -qec "$command 2>err" /dev/null </dev/null >/dev/null || true
  same "the line of $command" "${command%% *}: reads this terminal (Ctrl-D ends the input)" "$(head -1 err)"
done
script -qec "seed '$ball' -o /dev/null 2>err" /dev/null </dev/null >/dev/null
[[ ! -s err ]] || fail "$(cat err)"
