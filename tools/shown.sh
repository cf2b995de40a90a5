# A text from outside in a message: ASCII that can be printed, a question mark for each other byte.
shown() { printf %s "$1" | LC_ALL=C tr -c ' -~' '?'; }
