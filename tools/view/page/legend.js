// What is drawn over the picture, in a canvas of its own: axes and scale bar, the names of torsions that have turned,
// the hand, the flash at a snap, the force bar. Texts and sizes come from view, whose pictures have the same
// (libcore/scene/legend.hpp).

const kFlashSeconds = 0.8;
const kGrey = "#6b7280";

/// A canvas whose unit is a pixel of the page on a small screen, and its width and height in that unit.
function context(canvas, width, height) {
  const size = setSize(canvas, width, height);
  const c = canvas.getContext("2d"), unit = letterScale(), scale = window.devicePixelRatio * unit;
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.clearRect(0, 0, ...size);
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.font = "11px system-ui, sans-serif";
  Object.assign(c, { textBaseline: "middle", lineCap: "round" });
  return [c, width / unit, height / unit];
}

function strokeLines(c, lines, colour, width) {
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.beginPath();
  for (const [from, ...rest] of lines) {
    c.moveTo(...from);
    for (const to of rest) c.lineTo(...to);
  }
  c.stroke();
}

/// From one place; those that point at the viewer are left out.
function drawAxes(c, height, length) {
  const { axes_aside, axes_above, axis_gap, shortest_axis } = data.legend, [right, up] = view.axes;
  const middle = [axes_aside + length, height - axes_above - length];
  c.textAlign = "center";
  [..."xyz"].forEach((name, a) => {
    const at = (far) => [middle[0] + far * right[a], middle[1] - far * up[a]];
    if (Math.hypot(right[a], up[a]) < shortest_axis) return;
    strokeLines(c, [[middle, at(length)]], data.ink, data.legend.line);
    c.fillText(name, ...at(length + axis_gap));
  });
  c.textAlign = "left";
}

/// The longest of the bars that view has a text for and that is short enough, or the shortest.
function drawScaleBar(c, width, height, unit) {
  const { margin, line, bar_end, bar_gap, bar_part } = data.legend;
  const [length, text] = data.lengths.reduce((best, next) => (next[0] <= bar_part * width * unit ? next : best));
  const right = margin + length / unit, y = height - margin;
  strokeLines(c, [[[margin, y], [right, y]], ...[margin, right].map((x) => [[x, y - bar_end], [x, y + bar_end]])], data.ink, line);
  c.fillText(text, right + bar_gap, y);
}

/// In a column to the right of the rightmost sphere, so that they cover none, each at the height of its bond's middle or
/// below the one before. A dot marks the bond; the line towards it ends before it crosses a sphere.
function nameTurned(c, width, height, frame, place, unit) {
  const { margin, name_row } = data.legend;
  const beside = data.spheres.reduce((most, _, k) => Math.max(most, place(sphere(frame, k))[0] + drawnRadius(k) / unit), 0);
  const middle = (a, b) => place(plus(sphere(frame, a), plus(sphere(frame, b), sphere(frame, a), -1), 0.5));
  let y = margin, leftOver = frame.turned.length;
  for (const [at, text] of frame.turned.map(([a, b, text]) => [middle(a, b), text]).sort((one, other) => one[0][1] - other[0][1])) {
    const left = Math.min(beside + 2 * margin, width - margin - c.measureText(text).width);
    y = Math.max(y, Math.min(at[1], height - name_row * leftOver--));
    const from = [left - margin / 2, y], part = Math.max(0, (from[0] - beside) / (from[0] - at[0]));
    strokeLines(c, [[from, from.map((x, i) => x + part * (at[i] - x))]], data.ink, data.legend.line);
    for (const [wider, colour] of [[1, "#fff"], [0, data.ink]]) strokeLines(c, [[at, [at[0] + 0.01, at[1]]]], colour, 2 * (data.legend.dot + wider));
    c.fillText(text, left, y);
    y += name_row;
  }
}

/// With a white edge, so that they are seen on every colour.
function drawThread(c, line, colour, dashes = []) {
  for (const [shade, wider, gaps] of [["#fff", 2, []], [colour, 0, dashes]]) {
    c.setLineDash(gaps);
    strokeLines(c, [line], shade, data.hand_line_pixels + wider);
  }
  c.setLineDash([]);
}

/// With a white edge.
function drawText(c, text, x, y) {
  Object.assign(c, { strokeStyle: "#fff", lineWidth: 3, fillStyle: data.ink });
  c.strokeText(text, x, y);
  c.fillText(text, x, y);
}

function drawRing(c, [x, y], radius, colour) {
  const turn = (k) => Math.PI * k / 32;
  drawThread(c, Array.from({ length: 65 }, (_, k) => [x + radius * Math.cos(turn(k)), y + radius * Math.sin(turn(k))]), colour);
}

/// A ring where the hand is, and a thread from there to the HIP: the longer, the more the model resists. Where there is no
/// force it is dashed: the ball is still on its way, or the hand is outside of the box, where the ball cannot follow.
function drawHand(c, frame, place, width) {
  const hand_ = hand && following() ? hand : frame.hand, ring = data.ring_pixels;
  if (!finite(hand_)) return;
  const at = place(hand_), hip = place(frame.hip);
  const away = Math.hypot(hip[0] - at[0], hip[1] - at[1]);
  const pulls = frame.size > 0.01 * (data.full_force || 1);
  const outside = hand_.some((x, a) => x < data.low[a] || x > data.high[a]);
  if (away > ring) drawThread(c, [at.map((x, i) => x + ring * (hip[i] - x) / away), hip], pulls ? data.hand_colour : kGrey, pulls ? [] : [5, 5]);
  if (outside && away > ring) {
    const text = "edge of the grid", half = c.measureText(text).width / 2;
    drawText(c, text, clamp(at[0], half + 4, width - half - (hasForceBar() ? 70 : 4)) - half, at[1] + 2 * ring);
  }
  drawRing(c, at, ring, data.hand_colour);
}

/// Somebody who wants nothing that flashes or shakes.
const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/// Rings around the HIP for a moment after the model snapped.
function drawFlash(c, frame, place, unit) {
  for (let i = shown; i >= 0 && frames[i].time >= frame.time - kFlashSeconds; --i) {
    if (!frames[i].snapped) continue;
    const at = place(frame.hip), radius = data.hip_radius / unit;
    if (!calm()) for (const wider of data.flash_pixels) drawRing(c, at, radius + wider, data.snap_colour);
    c.textAlign = "center";
    drawText(c, "snap", at[0], at[1] - radius - data.flash_pixels[1] - 9);
    c.textAlign = "left";
    return;
  }
}

/// The name of the atom that is seen at a place of the picture, in pixels.
function nameAt(frame, at) {
  const near = view.axes[2], unit = pixel();
  let name = "", nearest = -Infinity;
  data.names.forEach((one, k) => {
    const centre = sphere(frame, k), away = unit * Math.hypot(...inPicture(centre).map((x, i) => x - at[i]));
    const front = dot(near, centre) + Math.sqrt(drawnRadius(k) ** 2 - away ** 2);  // NaN beside the sphere
    if (front > nearest) [name, nearest] = [one, front];
  });
  return name;
}

const hasForceBar = () => live && data.full_force > 0;

/// The largest force so far, at least a tenth of the grid's, rounded up to 1, 2 or 5 times a power of ten.
function barForce() {
  const least = Math.max(largestForce, data.full_force / 10), power = Math.pow(10, Math.floor(Math.log10(least)));
  return [1, 2, 5, 10].map((digit) => digit * power).find((f) => f >= least * (1 - 1e-9));
}

function drawForceBar(c, width, height, force) {
  const x = width - 33, top = 0.4 * height, bottom = height - 26, full = barForce(), part = clamp(force / full, 0, 1);
  c.fillStyle = data.force_colour;
  c.fillRect(x, bottom - part * (bottom - top), 14, part * (bottom - top));
  c.strokeStyle = data.ink;
  c.lineWidth = 1;
  c.strokeRect(x, top, 14, bottom - top);
  c.fillStyle = data.ink;
  c.textAlign = "right";
  c.fillText(`${threeDigits(full)} N`, width - 8, top - 10);
  if (data.full_force <= full) {  // what is sent at most
    const y = bottom - data.full_force / full * (bottom - top);
    strokeLines(c, [[[x - 4, y], [x + 14, y]]], data.ink, 2);
    c.fillText("limit", x - 7, y);
  }
  c.fillText("0", width - 23, bottom + 10);
  c.textAlign = "left";
}

function drawLegend() {
  const [c, width, height] = context(element("legend"), ...pictureSize());
  const scale = letterScale(), unit = pixel() * scale, shorter = Math.min(width, height), large = shorter >= data.legend.smallest;
  const place = (v) => inPicture(v).map((x) => x / scale);
  c.fillStyle = data.ink;
  if (large) {
    drawScaleBar(c, width, height, unit);
    drawAxes(c, height, Math.min(data.legend.axis, data.legend.axis_part * shorter));
  }
  if (frames.length === 0) return;
  const frame = frames[shown];
  drawStrips(frame);
  if (data.own) markTorsions(c, frame, place, [width, height]);
  else if (large) nameTurned(c, width, height, frame, place, unit);
  drawHand(c, frame, place, width);
  if (pointed) drawText(c, nameAt(frame, pointed), pointed[0] / scale + 12, pointed[1] / scale - 10);
  drawFlash(c, frame, place, unit);
  if (large && hasForceBar()) drawForceBar(c, width, height, frame.size);
}
