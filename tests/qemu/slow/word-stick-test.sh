# All cells of the table of examples/devices/README.md in the emulated machine: a stick with force.
source "$(dirname "$0")/../words.sh"
all_words stick
