import os
import sys

from hapgrid.apps.common.needs import look_for

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads would only wait
look_for("table", sys.argv[1:], ["jinja2", "matplotlib", "numpy"])
from hapgrid.apps.table import cli  # noqa: E402

sys.exit(cli.main(sys.argv[1:]))
