"""The house style of hapgrid's plots."""

import os
import sys

from .files import Failed


def style(work):
    """The module hapgrid.style, which lies beside the filters. Errors: Failed, where matplotlib is not there."""
    filters = os.path.dirname(os.path.realpath(os.path.join(work.filters, "play")))
    sys.path.append(os.path.join(filters, "../python"))
    try:
        from hapgrid import style as module
        module.matplotlib()
    except ImportError as why:
        raise Failed(str(why)) from None
    return module
