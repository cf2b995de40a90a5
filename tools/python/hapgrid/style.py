"""The house style of all plots: figure() makes one, save() writes it by its file's name.

Lines have a contrast of at least 3 on white, texts of 4.5, and the colours differ for the colour-blind (after Okabe and
Ito, Color Universal Design, 2008, darkened). The same data give the same bytes: files hold no date, and SVGs no random
names. Letters of an SVG and of a PDF are text.
"""
from __future__ import annotations

import contextlib
import io
import logging
import os
import unicodedata
import warnings
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from hapgrid.files import write_whole

BLUE, ORANGE, GREEN, PURPLE, BROWN, GREY = "#0072b2", "#c8500a", "#00805e", "#9a4f86", "#806000", "#6b6b6b"
FORCE, ENERGY, SNAP = "#008073", "#1e5abe", "#b05405"  # as pages, films and the terminal have them (libcore/scene/drawing.hpp)
COLOURS = [BLUE, ORANGE, GREEN, PURPLE, BROWN, GREY]
MARKERS = "osD^vP"
TEXT = "#222222"
FORMATS = {".png": "png", ".svg": "svg", ".pdf": "pdf"}
LONGEST = 120  # characters of a text from outside
LEGEND = 84  # letters beside each other in a legend, about
SIGNS = {"angstrom": "Å", "angstroms": "Å", "um": "µm", "degrees": "°"}
TYPE = {"png": {"Software": None}, "svg": {"Date": None, "Creator": "hapgrid"}, "pdf": {"CreationDate": None, "Creator": "hapgrid"}}
STYLE = {
    "font.family": ["DejaVu Sans"], "font.size": 10, "axes.titlesize": 10, "axes.labelsize": 10, "legend.fontsize": 9,
    "xtick.labelsize": 9, "ytick.labelsize": 9, "figure.dpi": 160, "savefig.dpi": 160, "savefig.facecolor": "white",
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8, "axes.axisbelow": True,
    "axes.edgecolor": "#444444", "axes.labelcolor": TEXT, "text.color": TEXT, "xtick.color": "#444444",
    "ytick.color": "#444444", "xtick.labelcolor": TEXT, "ytick.labelcolor": TEXT, "axes.titlelocation": "left",
    "lines.linewidth": 1.5, "lines.markersize": 4.5,
    "lines.solid_capstyle": "round", "legend.frameon": False, "legend.handlelength": 1.8, "legend.borderaxespad": 0,
    "axes.formatter.useoffset": False, "axes.formatter.use_mathtext": True, "axes.formatter.limits": (-4, 5),
    "axes.unicode_minus": True, "svg.fonttype": "none", "svg.hashsalt": "hapgrid", "pdf.fonttype": 42,
    "figure.constrained_layout.use": True, "path.simplify": True, "agg.path.chunksize": 20000, "image.interpolation": "none",
}


def matplotlib() -> ModuleType:
    """The module. Raises ImportError, with the package to install, where it is not there."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # of its caches and fonts
    try:
        import matplotlib as module
        import matplotlib.figure
    except ImportError as why:
        raise ImportError(f"{why}: install the Debian package python3-matplotlib, or pip install 'hapgrid[plot]'") from None
    return module


@contextlib.contextmanager
def house_style() -> Iterator[Any]:
    """What is drawn inside has the house style, whatever a user's own settings are."""
    module = matplotlib()
    with module.rc_context(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of letters that the font does not have
        module.rcdefaults()
        module.rcParams.update(STYLE)
        yield module


def figure(width: float = 6.2, height: float = 3.6) -> Any:
    """An empty figure; inches, of which the width of a PNG has 160 pixels each. A notebook shows it."""
    with house_style() as module:
        class Figure(module.figure.Figure):  # type: ignore[misc, name-defined]
            def _repr_png_(self) -> bytes:
                return picture(self, "png")

        return Figure((width, height))


def picture(drawn: Any, kind: str) -> bytes:
    """A figure as the bytes of a file of this kind: "png", "svg" or "pdf"."""
    file = io.BytesIO()
    with house_style():
        drawn.savefig(file, format=kind, metadata=TYPE[kind])
    return file.getvalue()


def kind_of(name: str) -> str:
    """The kind of picture that a file's name asks for. Raises ValueError where it has none of the endings."""
    ending = os.path.splitext(name)[1].lower()
    if ending not in FORMATS:
        raise ValueError(f"{name}: the name of a picture ends with {', '.join(FORMATS)}")
    return FORMATS[ending]


def save(drawn: Any, name: str | os.PathLike[str]) -> None:
    """Writes a figure as PNG, SVG or PDF, by the file's name; the file is whole, or as it was. Raises OSError, ValueError."""
    name = os.fspath(name)
    content = picture(drawn, kind_of(name))
    if os.path.exists(name) and not os.path.isfile(name):
        with open(name, "wb") as file:
            file.write(content)
        return
    write_whole(name, content)


def plain(text: str) -> str:
    """A text from outside as letters alone: no formula, no line's end, nothing that cannot be seen."""
    seen = "".join("?" if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp") else c for c in text)
    return (seen if len(seen) <= LONGEST else seen[:LONGEST - 3] + "...").replace("$", r"\$")


def sign(unit: str) -> str:
    """A unit as it is printed."""
    return SIGNS.get(unit, unit)


def place(value: float, spacing: float) -> str:
    """A place of a point, to a thousandth of the spacing."""
    import math

    digits = max(0, 3 - math.floor(math.log10(spacing))) if 0 < spacing < 1e9 else 0
    text = f"{round(value, min(digits, 12)) + 0.0:.{min(digits, 12)}f}"  # + 0.0: no negative zero
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "\u2212")


def label(quantity: str, unit: str = "") -> str:
    """What an axis says, as "force / N" (ISO 80000-1); a unit that is a quotient gets brackets."""
    unit = sign(unit)
    bracketed = f"({unit})" if "/" in unit and not unit.startswith("(") else unit
    return plain(f"{quantity} / {bracketed}" if unit else quantity)


def legend(axes: Any, columns: int = 0) -> None:
    """The legend above a plot where there is more than one thing to tell apart, so that it covers no curve."""
    names = axes.get_legend_handles_labels()[1]
    if len(names) > 1:
        columns = columns or max(1, min(len(names), int(LEGEND / (6 + max(map(len, names))))))
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncol=columns, columnspacing=1.4)


def limits(axes: Any, values: Any) -> None:
    """Limits of the vertical axis with some room. A curve that hardly changes is a straight line in the middle."""
    import numpy

    values = numpy.asarray(values, float)
    values = values[numpy.isfinite(values)]
    low, high = (values.min(), values.max()) if values.size else (0.0, 0.0)
    size = max(abs(low), abs(high))
    margin = 0.07 * (high - low) if high - low > max(1e-9 * size, 1e-30) else (size or 1.0)
    axes.set_ylim(low - margin, high + margin)
