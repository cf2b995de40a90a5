"""hapgrid plot: pictures of grids and plays, by hapgrid.plot of the Python module."""
from __future__ import annotations

import argparse
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from typing import NoReturn

from hapgrid.apps.common.cli import formatter

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads would only wait

ABOUT = """\
Draws grids and plays as a paper does: PNG, SVG or PDF, by the ending of the
picture's name. The same pictures come from hapgrid.plot in Python.
"""
KINDS = """\
Pictures:
  slice GRID            how many levels the points of a plane have
  field GRID            energy contours and force arrows in a plane, and
                        where the model's spheres cut it
  columns LOG...        column Y over column X of logs, sessions or frames, one
                        over the other; there and back, with the snaps
  session LOG           what happened in a play, over time: force, HIP, energy,
                        lateness, and what the safety core did
  error GRID...         how far play is from the model, over the spacing of
                        grids of one or several models (verify --walks)

Columns:
  t; x y z of the HIP; force_x ..., of the model, and sent_x ..., as sent; force
  and sent, their lengths; l0 ... l7; s0 ...; energy; own_energy. A session has
  states and energies together with --grid.

Exit codes:
  0  done
  1  could not: input, I/O, a model
  2  the command line is wrong; nothing was read or written

Examples:
  hapgrid plot slice ball.grid --at y=0 -o levels.png
                        the levels in a plane
  hapgrid plot columns a.log --x x --y s0 --grid ball.grid -o loop.svg
                        a state over the hand's place, there and back
  hapgrid plot error 20.grid 30.grid 60.grid -o error.png
                        how far play is from the model
"""


class Wrong(Exception):
    """Of the command line."""


class Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:  # one line, as every other message
        raise Wrong(message)


def arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = Parser(prog="plot", usage="hapgrid plot PICTURE FILE... -o FILE [OPTION...]", description=ABOUT, epilog=KINDS,
                    allow_abbrev=False, add_help=False, formatter_class=formatter)
    parser.add_argument("picture", choices=["slice", "field", "columns", "session", "error"], help=argparse.SUPPRESS)
    parser.add_argument("files", metavar="FILE", nargs="+", help=argparse.SUPPRESS)
    parser.add_argument("-o", "--output", metavar="FILE", help="picture to write ('-': a PNG to standard output)")
    parser.add_argument("--at", metavar="AXIS=VALUE", help="plane of a slice or field (default: y in the middle)")
    parser.add_argument("--x", metavar="COLUMN", help="column along the horizontal axis (default: t)")
    parser.add_argument("--y", metavar="COLUMN", help="column along the vertical axis")
    parser.add_argument("--grid", metavar="GRID", help="grid that was played: units, and a session's states and energies")
    parser.add_argument("--allow-process", metavar="MODEL.toml",
                        help="definition whose command may be run as the model, for error, and for a session with --grid")
    parser.add_argument("-h", "--help", action="help", help="print this help and exit")
    parser.add_argument("-V", "--version", action="store_true", help="print the version and exit")
    if words in (["-V"], ["--version"]):
        import hapgrid

        print(f"plot (hapgrid) {hapgrid.__version__}")
        sys.exit(0)
    return checked(parser.parse_args(words))


def checked(options: argparse.Namespace) -> argparse.Namespace:
    """The options, where each of them means something for the picture. Raises Wrong."""
    from hapgrid.style import kind_of

    mine = {"slice": {"at"}, "field": {"at"}, "columns": {"x", "y", "grid", "allow_process"},
            "session": {"grid", "allow_process"}, "error": {"allow_process"}}[options.picture]
    for name in ("at", "x", "y", "grid", "allow_process"):
        if getattr(options, name) is not None and name not in mine:
            raise Wrong(f"--{name.replace('_', '-')} is not for {options.picture}")
    if options.allow_process is not None and options.grid is None and options.picture != "error":
        raise Wrong("--allow-process needs --grid, in which a session is replayed")
    if options.picture in ("slice", "field", "session") and len(options.files) != 1:
        raise Wrong(f"{options.picture} draws one file, not {len(options.files)}")
    if options.picture == "columns" and options.y is None:
        raise Wrong("columns needs --y COLUMN")
    if options.output is None:
        raise Wrong("-o FILE is missing")
    if options.output == "-":
        if sys.stdout.isatty():
            raise Wrong("a picture is not written to a terminal")
        return options
    try:
        kind_of(options.output)
    except ValueError as why:
        raise Wrong(f"-o: {why}") from None
    return options


def draw(options: argparse.Namespace) -> None:
    from hapgrid import plot, style

    if options.picture == "slice":
        figure = plot.slice(options.files[0], options.at)
    elif options.picture == "field":
        figure = plot.field(options.files[0], options.at)
    elif options.picture == "columns":
        figure = plot.columns(options.files, options.x or "t", options.y, grid=options.grid, allow_process=options.allow_process)
    elif options.picture == "session":
        figure = plot.session(options.files[0], options.grid, options.allow_process)
    else:
        more = [f"--allow-process={options.allow_process}"] if options.allow_process else []
        figure = plot.error(options.files, options=more)
    if options.output == "-":
        sys.stdout.buffer.write(style.picture(figure, "png"))
        sys.stdout.buffer.flush()
    else:
        plot.save(figure, options.output)


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    warnings.showwarning = lambda message, *_: print(f"plot: {message}", file=sys.stderr)
    try:
        draw(arguments(sys.argv[1:]))
    except Wrong as why:
        print(f"plot: {why} (see plot --help)", file=sys.stderr)
        return 2
    except OSError as why:
        print(f"plot: {why.filename}: {why.strerror}" if why.filename else f"plot: {why}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as why:  # numpy, which everything needs; matplotlib's own message says as much
        print(f"plot: {why}: install the Debian package python3-matplotlib, or pip install 'hapgrid[plot]'", file=sys.stderr)
        return 1
    except (ValueError, ImportError) as why:
        print(f"plot: {' '.join(str(why).split())}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
