import sys

from hapgrid.apps.common.needs import look_for

look_for("molecule", sys.argv[1:], ["jinja2", "numpy", "rdkit", "scipy"], [("libxtb.so.6", "libxtb6")])
from hapgrid.apps.molecule import cli  # noqa: E402

sys.exit(cli.main(sys.argv[1:]))
