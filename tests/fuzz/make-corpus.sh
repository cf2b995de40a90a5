#!/bin/bash
# Writes the part of the corpora that real outputs of the tools are: `made-*` in corpus/TARGET. The
# rest of the files there is what the fuzzer found (tests/README.md). Needs a build (HAPGRID_BIN) and cc;
# what it writes depends on the versions of zstd and of the compiler's libraries, so it is committed.
#
#   tests/fuzz/make-corpus.sh [CORPUS]
corpus=$(realpath -m "${1:-$(dirname "$0")/corpus}")
source "$(dirname "$0")/../cli/lib.sh"
rm -f "$corpus"/*/made-*
# put TARGET NAME < what goes there
put() {
  mkdir -p "$corpus/$1"
  cat >"$corpus/$1/made-$2"
}

# Shards: seeds, requests, a grid on its way and finished, small, with and without what is stored; two
# sections in one file.
small=(--set grid.spacing=0.25 --set 'grid.counts=[6,3,2]' --set 'grid.origin=[-0.7,-0.2,-0.1]')
seed "$ball" "${small[@]}" >seeds
expand seeds >requests
merge seeds requests -o next
expand --complete seeds >grid
merge --small grid -o small
for k in 1 2; do expand --part "$k/2" next; done >both
seed "$ball" "${small[@]}" --set model.parameters.stored=true | expand --complete >stored
for shard in seeds requests next both grid small stored; do
  put shard "$shard" <"$shard"
done
# Compressed bytes are as good as random ones, and the first says which kind of grid is made of them.
for bytes in 300 1000 3000; do
  (printf '\0'; head -c "$bytes" <(cat grid stored requests next)) | put traversal "noise-$bytes"
  (printf '\1'; head -c "$bytes" <(cat grid stored requests next)) | put traversal "branches-$bytes"
done

# Sessions, whole and cut, their text, and frames.
for step in {0..84}; do
  LC_ALL=C awk -v i="$step" 'BEGIN { print -0.7 + 0.0125 * i, 0.1, 0.05 }'
done >path
play stored --device path:path --log played.session --frames frames 2>/dev/null
put session played <played.session
head -c -30 played.session | put session cut
put streams frames-played <frames
head -c -20 frames | put streams frames-cut

# Texts for people; corpus.sh adds those of the examples.
(cat "$ball"; printf '\0grid.counts=[5, 4, 3]') | put texts definition-override
head -n 20 path | put texts path-path
head -n 20 "$HAPGRID_SOURCE/examples/hung-ball/path-there-and-back.txt" | put texts path-example

# What --cost appends to.
expand --cost cost seeds >requests
expand --complete --cost cost seeds >grid
merge --cost cost seeds requests >next
sed 's/"host":"[^"]*"/"host":"node1"/' cost | put texts cost-three
printf '{"cpu_seconds": 0, "conversions": 18446744073709551615}\n{"cpu_seconds": -1}' | put texts cost-refused

# A model process: what the hung ball says.
printf '%s\n' '{"hapgrid": 1, "parameters": {}}' '{"id": 1, "op": "known_states", "x": [-0.4, 0, 0]}' \
  '{"id": 2, "op": "convert", "s": [0.1], "x": [-0.4, 0, 0], "d": [0.05, 0, 0]}' |
  PYTHONPATH=$HAPGRID_BUILD/python python3 "$HAPGRID_SOURCE/examples/hung-ball/hung_ball.py" | put process ball
cat <<'JSON' | put process stored
{"hapgrid": 1, "state_size": 2, "d_max": 0.5, "tolerance": 1e-6, "tolerance_unit": "m", "norm": "rms", "weights": [1, 2], "length_unit": "m", "energy_unit": "J", "force_scale": 1.5, "hip_radius": 0.1, "stored": ["force", "energy", "shape"], "spheres": [{"radius": 0.1, "colour": [1, 0, 0.5], "label": "H"}]}
{"id": 1, "s": [0.5, -1e-3], "force": [0, 1, 2], "energy": -7, "shape": [1, 2, 3]}
{"id": 2, "states": [[0, 1], [2.5, 3]], "more": {"deep": [[1], {"s": [2]}]}}
{"id": 3, "error": "no convergence"}
JSON

# An adapter: what the handle on a spring says, and answers to forces from the first on.
python3 - "$HAPGRID_SOURCE/examples/devices/handle.py" <<'PYTHON' | put streams adapter-handle
import socket, struct, subprocess, sys
ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
with subprocess.Popen([sys.executable, sys.argv[1]], stdin=its, stdout=its):
    said = ours.recv(200)
    for number in range(1, 5):
        ours.send(struct.pack("<3d2I", 0.1 * number, 0, 0, number, number == 4))
        said += ours.recv(200)
sys.stdout.buffer.write(said)
PYTHON

# What viewers and terminals send.
# GO, TRATE 3, PAUSE; GO, MDCOMM of one atom, DISCONNECT. The first byte is the length of a piece less one.
printf '\x04\0\0\0\3\0\0\0\0\0\0\0\x08\0\0\0\3\0\0\0\7\0\0\0\0' | put streams imd-pause
printf '\x0d\0\0\0\3\0\0\0\0\0\0\0\6\0\0\0\1\0\0\0\2abcdefghijkl\0\0\0\0\0\0\0\0' | put streams imd-forces
printf '\x1b[C\x1b[D\x1bOA\x1b[5~\x1b[6~\x1b[1;5B++--0r\x1b[Cq' | put streams keys-keys
du -sb "$corpus"/* | sort -n
