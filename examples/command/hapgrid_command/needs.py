"""What a command needs beside hapgrid. It is looked for before anything begins: a run can take hours."""

import ctypes
import importlib.util
import shutil
import sys


def look_for(command, arguments, modules, libraries=()):
    """Ends the command with one line that names what is missing, and Debian's packages. modules: of Python, besides those
    that draw, which a run with --until does without; libraries: (file, package)."""
    if {"-h", "--help"} & set(arguments):
        return
    draws = not any(word.split("=")[0] == "--until" for word in arguments)
    packages = {name: f"python3-{name}" for name in (*modules, *(["matplotlib"] if draws else []))}
    missing = {name: package for name, package in packages.items() if importlib.util.find_spec(name) is None}
    for file, package in libraries:
        try:
            ctypes.CDLL(file)
        except OSError:
            missing[file] = package
    if shutil.which("setpriv") is None:
        missing["setpriv"] = "util-linux"
    if missing:
        several = len(missing) > 1
        sys.exit(f"{command}: {', '.join(missing)} {'are' if several else 'is'} missing: install the Debian "
                 f"package{'s' if several else ''} {' '.join(missing.values())}")
