"""Files that are whole, and names that are safe."""

import hashlib
import os
import re


class Failed(Exception):
    """What was asked for is not possible; the message is one line."""


def write_whole(path, content):
    """Writes a file so that it is there in full, or as it was before. content: text or bytes."""
    beside = f"{path}.new.{os.getpid()}"
    try:
        with open(beside, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except BaseException:
        if os.path.exists(beside):
            os.remove(beside)
        raise


def read_text(path):
    """Errors: Failed, where it is no text of UTF-8."""
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except UnicodeDecodeError:
        raise Failed(f"{path}: is no text: remove it") from None


def remove(path):
    """Removes a file that may not be there."""
    try:
        os.remove(path)
    except FileNotFoundError:
        pass


def digest(path):
    """A hash of a file's bytes, None where there is none."""
    try:
        with open(path, "rb") as file:
            return digest_of(file.read())
    except FileNotFoundError:
        return None


def digest_of(content):
    return hashlib.sha256(content).hexdigest()[:24]


def is_plain(name):
    """Whether this can be a file beside the others, whoever made the name. It needs no quotes anywhere."""
    return isinstance(name, str) and re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.+-]{0,199}", name) is not None
