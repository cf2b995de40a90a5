"""Texts have a contrast of at least 4.5 with white, and lines of 3 (WCAG 2.1, 1.4.3 and 1.4.11): in plots, in pages, in
pictures.

usage: contrast.py PAGE.html PLOT.svg...       (PAGE.html by view --html, plots by hapgrid plot)
"""
import json
import os
import re
import sys

TEXT, LINE = 4.5, 3
HEX = r"#(?:[0-9a-f]{6}|[0-9a-f]{3})\b"


def rgb(colour):
    if colour.startswith("rgb"):
        return [float(x) / 255 for x in re.findall(r"[\d.]+", colour)]
    digits = colour[1:] if len(colour) == 7 else "".join(2 * c for c in colour[1:])
    return [int(digits[i:i + 2], 16) / 255 for i in (0, 2, 4)]


def contrast(colour):
    """Of a colour with white: WCAG 2.1, "relative luminance"."""
    linear = [x / 12.92 if x <= 0.03928 else ((x + 0.055) / 1.055) ** 2.4 for x in rgb(colour)]
    return 1.05 / (sum(part * x for part, x in zip((0.2126, 0.7152, 0.0722), linear)) + 0.05)


assert contrast("#fff") == 1 and abs(contrast("#000000") - 21) < 1e-9 and abs(contrast("#777777") - 4.48) < 0.005
seen = []


def check(where, colours, least):
    for colour in colours:
        seen.append(where)
        assert contrast(colour) >= least, f"{where}: {colour}: contrast {contrast(colour):.2f}, and {least} is the least"


page, *plots = sys.argv[1:]
source = os.environ["HAPGRID_SOURCE"]
for plot in plots:
    with open(plot, encoding="utf-8") as file:
        svg = file.read()
    # The rims of markers and legends are white, and so is the frame of a picture.
    check(plot, set(re.findall(rf"stroke: ({HEX})", svg)) - {"#ffffff"}, LINE)
    check(plot, re.findall(rf"<text[^>]*fill: ({HEX})", svg), TEXT)
for name in ("tools/view/page/page.html", "tools/python/hapgrid/apps/common/page.html"):
    with open(f"{source}/{name}", encoding="utf-8") as file:
        rules = re.findall(r"([\w-]+): *([^;}\n]+)", file.read())
    check(name, [colour for key, value in rules if key.startswith("border") for colour in re.findall(HEX, value)], LINE)
    check(name, [colour for key, value in rules if key == "color" for colour in re.findall(HEX, value) if colour != "#fff"], TEXT)
with open(f"{source}/examples/guide/architecture.svg", encoding="utf-8") as file:
    svg = file.read()
check("architecture.svg", set(re.findall(rf"stroke: ({HEX})", svg)) - {"#ffffff"}, LINE)
check("architecture.svg", re.findall(rf"\.(?:note|title) *{{[^}}]*fill: ({HEX})", svg) + re.findall(rf"<svg[^>]*fill=\"({HEX})", svg), TEXT)
with open(page, encoding="utf-8") as file:
    data = json.loads(re.search(r"\nlet data = (.*?);\nconst recorded", file.read(), re.DOTALL)[1])
texts = {key for key in data if key.endswith("_colour")} - {"hand_colour"} | {"ink"}
check(page, [data[key] for key in texts], TEXT)
box = "rgb({} {} {})".format(*(255 * x for x in data["light"]["box_rgb"]))
check(page, [data["hand_colour"], box], LINE)
assert len(texts) == 4 and len(set(seen)) == len(plots) + 4, (texts, set(seen))
