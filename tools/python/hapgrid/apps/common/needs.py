"""What a command needs beside hapgrid. It is looked for before anything begins: a run can take hours."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import shutil
import sys
from collections.abc import Sequence


def _loads(library: str) -> bool:
    """In a process of its own: here it would read its settings, such as the number of threads, before they are made."""
    child = os.fork()
    if child == 0:
        try:
            ctypes.CDLL(library)
            os._exit(0)
        except OSError:
            os._exit(1)
    return os.waitpid(child, 0)[1] == 0


def look_for(command: str, arguments: Sequence[str], modules: Sequence[str], libraries: Sequence[tuple[str, str]] = (),
             programs: Sequence[tuple[str, str]] = ()) -> None:
    """Ends the command with one line that names what is missing, Debian's packages, and the extra by which pip gets modules.
    modules: of Python; libraries, programs: (file, package)."""
    if {"-h", "--help"} & set(arguments):
        return
    packages = {name: f"python3-{name}" for name in modules}
    missing = {name: package for name, package in packages.items() if importlib.util.find_spec(name) is None}
    missing |= {file: package for file, package in libraries if not _loads(file)}
    missing |= {file: package for file, package in (*programs, ("setpriv", "util-linux")) if shutil.which(file) is None}
    if missing:
        several = len(missing) > 1
        by_pip = [name for name in missing if name in packages]
        by_extra = f", or {' '.join(by_pip)} by pip install 'hapgrid[{command}]'" if by_pip else ""
        sys.exit(f"{command}: {', '.join(missing)} {'are' if several else 'is'} missing: install the Debian "
                 f"package{'s' if several else ''} {' '.join(missing.values())}{by_extra}")
