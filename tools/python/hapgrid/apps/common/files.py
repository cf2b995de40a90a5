"""Files that are whole, and names that are safe."""

from __future__ import annotations

import hashlib
import os
import re
import stat
from collections.abc import Iterator
from typing import TypeGuard

MOST_BYTES = 64 << 30  # of a file of ours, such as a grid


class Failed(Exception):
    """What was asked for is not possible; the message is one line."""


def pieces(path: str, most: int = MOST_BYTES) -> Iterator[bytes]:
    """The content of a file from outside, a MiB at a time. Errors: Failed, where it has more than `most` bytes, where it is
    a device or a pipe, for which nobody would wait, and where another file names it as no file can be named."""
    if "\0" in path:
        raise Failed(f"{path}: a file's name has no NUL")
    with open(path, "rb", opener=lambda path, flags: os.open(path, flags | os.O_NONBLOCK | os.O_NOCTTY)) as file:
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise Failed(f"{path}: is no regular file")
        if status.st_size > most:
            raise Failed(f"{path}: {status.st_size} bytes, the limit is {most}")
        while piece := file.read(min(most, 1 << 20)):
            most -= len(piece)
            yield piece


def read_bytes(path: str, most: int) -> bytes:
    return b"".join(pieces(path, most))


def read_text(path: str, most: int = 1 << 30) -> str:
    """With single line feeds. Errors: Failed, also where it is no text of UTF-8."""
    try:
        return read_bytes(path, most).decode().replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError:
        raise Failed(f"{path}: is no text: remove it") from None


def remove(path: str) -> None:
    """Removes a file that may not be there."""
    try:
        os.remove(path)
    except FileNotFoundError:
        pass


def digest(path: str) -> str | None:
    """A hash of a file's bytes, None where there is none."""
    found = hashlib.sha256()
    try:
        for piece in pieces(path):
            found.update(piece)
    except FileNotFoundError:
        return None
    return found.hexdigest()[:24]


def digest_of(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:24]


def is_plain(name: object) -> TypeGuard[str]:
    """Whether this can be a file beside the others, whoever made the name. It needs no quotes anywhere."""
    return isinstance(name, str) and re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.+-]{0,199}", name) is not None
