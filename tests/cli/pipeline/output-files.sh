# -o FILE appears whole or not at all; nothing is left beside it, hidden files included.
source "$(dirname "$0")/../lib.sh"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

cat >toy.toml <<END
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 3, 3]}
model = {plugin = "toy", parameters = {}}
END
seed toy.toml -o seeds
expand seeds -o requests
merge seeds requests -o merged
head -c 300 requests >cut
mkdir d

# A tool that fails leaves an existing file as it was, and makes none.
tools=(
  "seed toy.toml --set grid.spacing=2"
  "seed toy.toml --set grid.spacing=x"
  "expand cut"
  "expand requests"
  "expand --complete cut"
  "merge seeds cut"
  "merge seeds"
  "merge merged requests"
)
for tool in "${tools[@]}"; do
  echo old >d/out
  refuses '.*' -- $tool -o d/out
  same "old content after $tool" old "$(cat d/out)"
  nothing_left d out
  rm d/out
  refuses '.*' -- $tool -o d/out
  nothing_left d
done

# A new file replaces the old one, also one in the working directory. Symbolic links are in unit/base/file_test.cpp.
echo old >d/real
(cd d && seed ../toy.toml -o real)
cmp d/real seeds
nothing_left d real
rm d/*
# The usual permissions.
(umask 027 && seed toy.toml -o d/out)
same "mode" 640 "$(stat -c %a d/out)"
if strace -o /dev/null true 2>/dev/null && ! sanitized; then
  # The file's name is on the disk, too. Nothing changes the umask, which belongs to all threads.
  strace -o trace -e trace=rename,fsync,umask seed toy.toml -o d/out
  same "calls" "fsync rename fsync" "$(sed -n 's/(.*//p' trace | paste -sd ' ')"
fi
rm d/out

# Where there is no file to be made.
refuses 'seed: missing/out: No such file or directory' -- seed toy.toml -o missing/out
refuses 'seed: d: Is a directory' -- seed toy.toml -o d
refuses 'seed: toy.toml/out: Not a directory' -- seed toy.toml -o toy.toml/out
if [[ $(id -u) != 0 ]]; then
  chmod a-w d
  refuses 'seed: d/out: Permission denied' -- seed toy.toml -o d/out
  chmod u+w d
fi
# A device and a pipe are written to, and not replaced.
expect 0 '' '' -- seed toy.toml -o /dev/null
[[ -c /dev/null ]] || fail "/dev/null was replaced"
mkfifo pipe
cat pipe >read & seed toy.toml -o pipe
wait $!
cmp read seeds

# Ended in the middle: nothing is left, not even of the merge in memory; SIGKILL leaves the temporary file.
seed toy.toml --set model.parameters.milliseconds=50 -o slow
# Not all file systems have files without a name.
nameless=$(python3 -c 'import os; print(os.open(".", os.O_TMPFILE | os.O_RDWR))' 2>/dev/null || true)
for signal in TERM INT HUP KILL; do
  for command in "expand slow" "expand -j 2 slow" "expand --complete slow"; do
    echo old >d/out
    # In a shell of its own, which ignores no signal; INT is ignored in the background otherwise.
    python3 -c '
import signal, subprocess, sys, time
signal.signal(signal.SIGINT, signal.SIG_DFL)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
tool = subprocess.Popen(sys.argv[2:])
time.sleep(0.15)
number = getattr(signal, "SIG" + sys.argv[1])
# expand --complete takes a signal to keep what it has, but KILL. It has to be ready for it.
takes = "--complete" in sys.argv and sys.argv[1] != "KILL"
def ready():
    caught = next(line for line in open(f"/proc/{tool.pid}/status") if line.startswith("SigCgt"))
    return int(caught.split()[1], 16) >> (number - 1) & 1
while takes and tool.poll() is None and not ready():
    time.sleep(0.01)
assert tool.poll() is None, "over too soon"
tool.send_signal(number)
code = 128 + number if takes else -number
assert tool.wait(5) == code, tool.returncode' $signal $command -o d/out
    same "old content" old "$(cat d/out)"
    [[ $nameless || $signal != KILL ]] || rm d/.hapgrid.??????
    nothing_left d out
  done
done

# No output replaces what the same tool reads, by whichever name; merge may replace its own grid.
sed 's/^counts = .*/counts = [2, 6, 6]/; s/^spacing = .*/spacing = 0.15/' "$ball" >my.toml
echo 'a file' >data
printf '[model]\nplugin = "toy"\nfiles = {a = "data"}\n[grid]\norigin = [0, 0, 0]\nspacing = 1\ncounts = [2, 2, 2]\n' >files.toml
seed my.toml -o seeds
expand seeds --cost cost -o requests
merge seeds requests -o merged
expand --complete seeds -o grid
echo '-0.9 0 0' >path
play grid --device path:path --log my.session --frames frames 2>err
rm -rf d
mkdir d
cp seeds requests grid my.session frames cost my.toml data path d
ln -s seeds seeds.link
ln grid grid.link
refusals "$here/replaces.tsv"
for file in d/*; do cmp "$file" "${file##*/}"; done
merge seeds requests -o seeds
cmp seeds merged
