import os
import sys

from hapgrid.apps.common.needs import look_for

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads would only wait
look_for("dock", sys.argv[1:], ["jinja2", "numpy", "scipy"], programs=[] if "--atoms" in sys.argv else [("autogrid4", "autogrid")])
from hapgrid.apps.dock import cli  # noqa: E402

sys.exit(cli.main(sys.argv[1:]))
