# The folder of `hapgrid molecule` can have any name, be renamed and copied, and come from a stranger; and nothing is left of
# a command that was ended.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
printf '3\n\nH 0 0 1.0\nC 0 0 0\nN 0 0 -1.15\n' >'<img src=x>.xyz'
feel() { hapgrid molecule --push '<img src=x>.xyz' --method gfnff --spacing 1.2 --quiet -o "$@"; }

# The line that it prints is one for a shell, and no name is a tag of the page or an option of a filter.
name="-x 'q\" #<b>&amp; \$HOME"
said=$(feel "./$name") || fail "no grid in $name"
line=$(tail -n 1 <<<"$said")  # the first says that nothing turns
eval "words=($line)"
[[ ${words[2]} == "./$name/molecule.grid" && -s ${words[2]} ]] || fail "the grid of: $line"
[[ -s ./$name/path-past.txt ]] || fail "no way"
grep -q '<dd>&lt;img src=x&gt;\.xyz' "./$name/index.html" || fail "$(grep -o 'Made from.*' "./$name/index.html")"
! grep -q '<img src=x' "./$name/index.html" || fail "a file's name is a tag"
mv "./$name" firstplace

# Renamed and copied, nothing is computed again, and the page's commands still hold: they have no folder.
before=$(cd firstplace && stat -c '%n %Y' -- * | md5sum)
feel firstplace >/dev/null
cp -a firstplace twice
mv firstplace renamed
for folder in renamed twice; do
  expect 0 "~NOTHING TURNS .*hapgrid feel $folder/molecule\.grid" '' -- feel "$folder"
  same "files of $folder" "$before" "$(cd "$folder" && stat -c '%n %Y' -- * | md5sum)"
done
if strace -o /dev/null true 2>/dev/null; then  # a file system that has no locks
  strace -f -qq -o trace -e inject=flock:error=ENOLCK hapgrid molecule --push '<img src=x>.xyz' --method gfnff --spacing 1.2 \
    -o renamed >/dev/null 2>said || fail "$(cat said)"
  grep -q 'renamed cannot be locked (No locks available): let one run at a time work there' said || fail "$(cat said)"
fi
! grep -q 'firstplace' renamed/*.{html,toml,tsv,txt} renamed/.work/*.json || fail "the folder's name is in it"

# Files of one's own are safe: in a folder that is not hapgrid's, in that of another molecule, and where the results would be.
mkdir own && cp '<img src=x>.xyz' own/conformation.xyz && echo mine >own/calc.new.1
printf '3\n\nH 0 0 1.0\nN 0 0 0\nO 0 0 -1.2\n' >hno.xyz
before=$(find own renamed -type f -exec md5sum {} + | sort)
alone() { # WHY FILE DIR
  expect 2 '' "~molecule: $1" -- hapgrid molecule --push "$2" --method gfnff --uhf 0 --charge 0 -o "$3" -q
  same "files after $1" "$before" "$(find own renamed -type f -exec md5sum {} + | sort)"
}
alone 'own: has files that are none of hapgrid molecule: give a new folder' own/conformation.xyz own
(cd own && alone='\.: has files that are none of hapgrid molecule: give a new folder' &&
  expect 2 '' "~molecule: $alone" -- hapgrid molecule conformation.xyz -o .)
alone 'renamed: has other results, of CHN \(<img src=x>\.xyz\), not of HNO \(hno\.xyz\): give another folder, or remove this one' hno.xyz renamed
alone 'renamed/conformation\.xyz: lies in the folder of the results, renamed: copy it, or give another folder' renamed/conformation.xyz renamed

# A stranger's folder: no file in it names one outside, to be read, written or removed.
echo precious >victim.xyz
cp victim.xyz victim.txt
intact() { same "$1" 'precious precious' "$(cat victim.xyz victim.txt 2>&1 | xargs)"; }
stranger() { rm -rf bad && cp -a renamed bad; }
for path in ../victim "$PWD/victim" .. '../victim.xyz'; do
  stranger
  printf '%s\tsaddle\t1.00\ti100\t-\n' "$path" >>bad/report.tsv
  refuses "molecule: bad/report\.tsv: '.*' is no name of a path: remove the report, and all is computed anew" -- feel bad
  intact "report.tsv with $path"
done
stranger
sed -i 's/"made": {[^}]*}/"made": {"..\/victim.txt": "0"}/' bad/.work/stage-*.json
feel bad >/dev/null
intact "a made file"
! grep -q precious bad/index.html || fail "the page has what is outside"
stranger
echo '"../victim"' >bad/.work/name.json
feel bad >/dev/null
intact "the name"
for text in 's/^conformation = .*/conformation = "..\/victim.xyz"/' 's/^plugin = .*/plugin = "other"/' 's/^plugin.*/plugin = [/'; do
  stranger
  sed -i "$text" bad/molecule.toml
  refuses "molecule: bad/molecule\.toml: (names the file '\.\./victim\.xyz': only files beside it are used, with plain names|is no \
definition of a molecule)" -- feel bad
done
stranger
ln -sf ../victim.txt bad/index.html
refuses "molecule: bad/index\.html: is a link, which a folder of results must not have: remove it" -- feel bad
intact "a link"

# What is kept in another form is computed again, and a file that is not as it was written gets one line.
for form in '{"x": "no", "hessian": [[1, 2]]}' '{"key": 7, "made": ["a"], "value": {"sides": 3}}'; do
  stranger
  for file in bad/.work/*.json; do echo "$form" >"$file"; done
  feel bad --until definition >/dev/null 2>said || fail "$form: $(cat said)"
  cmp renamed/conformation.xyz bad/conformation.xyz || fail "$form: another conformation"
done
damaged() { # FILE TEXT
  stranger
  printf %b "$2" >"bad/$1"
  rm -f bad/index.html  # it reads report.tsv
  code=0
  feel bad >/dev/null 2>said || code=$?
  ((code < 2)) && (($(wc -l <said) == code)) || fail "$1 with '$2': $code $(cat said)"
}
for text in '' '\xff\n'; do
  for file in report.tsv rotors.tsv conformation.xyz; do damaged $file "$text"; done
done
for file in report.tsv rotors.tsv; do damaged $file 'name\n\t\tsaddle\n'; done
for text in '3\n\nH 0 0 1\nQq 0 0 0\nN 0 0 -1\n' '3\n\nH 0 0\n'; do damaged conformation.xyz "$text"; done

# What a killed command leaves is removed by the next one.
mkdir renamed/.work/.single-x
touch renamed/.way-3.{txt,log} renamed/.work/.single-x/node.xyz renamed/.selection.toml renamed/.room.npy renamed/verify.txt.new.123 renamed/.hapgrid.aB3x9_
feel renamed >/dev/null
nothing_left renamed .work $(cd twice && ls)
[[ ! -e renamed/.work/.single-x ]] || fail "a single point's folder is left"

# ended: whether no process has this folder in its environment's FOLDER any more, which the filters inherit.
ended() { ! grep -lqsz "^FOLDER=$folder\$" /proc/[0-9]*/environ; }
begun() { [[ -s $folder/pid ]]; }

# A signal ends the command and its filters, SIGKILL as well.
mkdir filters
ln -s "$HAPGRID_BIN"/* filters
rm filters/expand
printf '#!/bin/sh\necho free >&2\nkill -ABRT $$\n' >filters/expand
chmod +x filters/expand
cp -a renamed crash
rm crash/molecule.grid
HAPGRID_BIN=$PWD/filters refuses 'molecule: expand: ended by SIGABRT: free' -- \
  molecule '<img src=x>.xyz' --method gfnff --spacing 1.2 -o crash --quiet
printf '#!/bin/sh\necho $$ >pid\nexec sleep 300\n' >filters/expand
chmod +x filters/expand
for signal in TERM HUP KILL; do
  folder=signal-$signal
  cp -a renamed "$folder"
  rm "$folder"/{molecule.grid,pid} 2>/dev/null || true
  FOLDER=$folder HAPGRID_BIN=$PWD/filters molecule '<img src=x>.xyz' --method gfnff \
    --spacing 1.2 -o "$folder" --quiet >line 2>said &
  command=$!
  wait_for 240 "expand" begun
  kill "-$signal" "$command"
  code=0
  wait "$command" 2>/dev/null || code=$?
  same "exit code after $signal" "$((128 + $(kill -l "$signal")))" "$code"
  [[ $signal == KILL ]] || same "message" 'molecule: stopped; the same command goes on' "$(cat said)"
  wait_for 120 "end of all processes after $signal" ended
  rm "$folder/pid"
  feel "$folder" >/dev/null || fail "does not go on after $signal"
done

# The processes that look for barriers end with the first one, too.
folder=workers
FOLDER=$folder hapgrid molecule --push --smiles CCO -o "$folder" -j 2 --quiet >line 2>said &
command=$!
searching() { (($(grep -lsz "^FOLDER=$folder\$" /proc/[0-9]*/environ | wc -l) > 2)); }
wait_for 240 "workers" searching
kill -KILL "$command"
wait "$command" 2>/dev/null || true
wait_for 120 "end of the workers" ended

# Two commands in one folder do not run at once: the second waits, and finds everything done.
rm -rf both
feel both >one &
feel both >two
wait
same "the second's line" "$(cat one)" "$(cat two)"
