# Each tool, killed at each system call that changes a file, with each of its calls refused, and within
# limits of size, memory and descriptors: see faults.py. Here three commands are, on behalf of all; slow/faults.sh
# has all of them (FAULTS=all), at each byte that their files may have.
source "$(dirname "$0")/../cli/lib.sh"
needs strace strace
strace -o /dev/null true 2>/dev/null || skip "strace may not trace here"
sanitized && skip "the sanitizers make system calls of their own"

seed "$ball" --set 'grid.counts=[4,3,2]' -o grid
expand grid -o requests
for k in {1..8}; do expand grid --part "$k/8" -o "r.$k"; done
expand --complete grid -o complete
printf '%s\n' '-0.95 -0.45 -0.45' '-0.9 -0.44 -0.44' '-0.83 -0.38 -0.43' >path
play complete --device path:path --log log.session --frames frames 2>/dev/null
[[ ${FAULTS-} == all || $# != 0 ]] || set -- expand replaced session
python3 "$here/faults.py" "$ball" "${FAULTS:-some}" "$@"
