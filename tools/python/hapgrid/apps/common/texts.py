"""Texts from outside, such as names of files, on their way to a terminal.

They are shown without characters that a terminal obeys or that change how the rest is shown, as hapgrid's filters do it
(libcore/base/text.hpp): escape sequences, marks of writing direction, characters without width, other ends of lines.
"""

import unicodedata

# Of Unicode's Default_Ignorable_Code_Point what is in none of the categories below.
_IGNORABLE = {0x34F, 0x115F, 0x1160, 0x17B4, 0x17B5, 0x3164, 0xFFA0, *range(0x180B, 0x1810), *range(0xFE00, 0xFE10),
              *range(0xFFF0, 0xFFF9), *range(0xE0000, 0xE1000)}


def _shown(character: str) -> str:
    if character < " " or character == "\x7f":
        return " "
    unseen = unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp") or ord(character) in _IGNORABLE
    return "?" if unseen else character


def printable_line(text: str) -> str:
    """The text as one line; a control character is a space, what cannot be seen is a question mark. A long one, as with a
    name of thousands of letters from a stranger's file, is shown by its ends."""
    line = "".join(map(_shown, text))
    return line if len(line) <= 2000 else f"{line[:1500]} ... {line[-400:]}"


def printable_text(text: str) -> str:
    """The same for several lines."""
    return "\n".join(map(printable_line, text.split("\n")))
