# Files of molecules that are none: what has no end, or is large, is refused before it is read.
source "$(dirname "$0")/../cli/lib.sh"
hapgrid molecule --help >help 2>&1 || { missing "$(head -1 help)"; exit 77; }
molecule() { refuses "molecule: $1\\.xyz: $2" -- timeout 60 hapgrid molecule "$1.xyz" -o out; }
ln -s /dev/zero zero.xyz
mkfifo pipe.xyz
mkdir folder.xyz
head -c 8388609 /dev/zero >large.xyz
printf '2\n\0\n' >bytes.xyz
ln -s missing link.xyz
molecule zero 'is no regular file'
molecule pipe 'is no regular file'
molecule folder 'Is a directory'
molecule large '8388609 bytes, the limit is 8388608'
molecule bytes 'not a text file'
molecule link 'No such file or directory'
