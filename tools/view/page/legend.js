// What is drawn over the picture, in a canvas of its own: axes and scale bar, the names of torsions that have turned,
// the hand, the flash at a snap, the force bar. Texts and sizes come from view; sizes are those of its pictures.

const kFlashSeconds = 0.3;
const kInk = "#292b33";

/// A canvas whose unit is a pixel of the page on a small screen, and its width and height in that unit.
function context(canvas, width, height) {
  const size = setSize(canvas, width, height);
  const c = canvas.getContext("2d"), unit = letterScale(), scale = window.devicePixelRatio * unit;
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.clearRect(0, 0, ...size);
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.font = "11px system-ui, sans-serif";
  c.textBaseline = "middle";
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
function drawAxes(c, x, y, length) {
  const { right, up } = axes();
  c.textAlign = "center";
  [..."xyz"].forEach((name, a) => {
    const shown = Math.hypot(right[a], up[a]);
    if (shown < data.axes.shortest) return;
    const at = (far) => [x + far * right[a] / shown, y - far * up[a] / shown];
    strokeLines(c, [[[x, y], at(length * shown)]], kInk, 1.2);
    c.fillText(name, ...at(length * shown + data.axes.gap));
  });
  c.textAlign = "left";
}

/// The longest of the bars that view has a text for and that is short enough, or the shortest.
function drawScaleBar(c, width, height, unit) {
  const [length, text] = data.lengths.reduce((best, next) => (next[0] <= 0.25 * width * unit ? next : best));
  const left = 10, right = left + length / unit, y = height - 10;
  strokeLines(c, [[[left, y], [right, y]], ...[left, right].map((x) => [[x, y - 3], [x, y + 3]])], kInk, 1.2);
  c.fillText(text, right + 5, y);
}

/// Each at the middle of its bond, and none over another one.
function nameTurned(c, frame, place) {
  const plates = [];
  for (const [a, b, text] of frame.turned) {
    let [x, y] = place(plus(sphere(frame, a), plus(sphere(frame, b), sphere(frame, a), -1), 0.5));
    const wide = c.measureText(text).width + 8;
    while (plates.some(([px, py, pw]) => Math.abs(x - px) < (wide + pw) / 2 && Math.abs(y - py) < 16)) y += 16;
    plates.push([x, y, wide]);
    c.fillStyle = "#fffd";
    c.fillRect(x - wide / 2, y - 8, wide, 16);
    c.fillStyle = kInk;
    c.fillText(text, x - wide / 2 + 4, y);
  }
}

function drawRing(c, [x, y], radius, colour) {
  c.strokeStyle = colour;
  c.lineWidth = 2;
  c.beginPath();
  c.arc(x, y, radius, 0, 2 * Math.PI);
  c.stroke();
}

/// A ring where the hand is, and a thread from there to the HIP: the longer, the more the model resists.
function drawHand(c, frame, place) {
  const hand_ = hand && following() ? hand : frame.hand, ring = data.ring_pixels;
  if (!finite(hand_)) return;
  const at = place(hand_), hip = place(frame.hip);
  const away = Math.hypot(hip[0] - at[0], hip[1] - at[1]);
  if (away > ring) strokeLines(c, [[at.map((x, i) => x + ring * (hip[i] - x) / away), hip]], data.hand_colour, 2);
  drawRing(c, at, ring, data.hand_colour);
}

/// Rings around the HIP for a moment after the model snapped.
function drawFlash(c, frame, place, unit) {
  for (let i = shown; i >= 0 && frames[i].time >= frame.time - kFlashSeconds; --i) {
    if (!frames[i].snapped) continue;
    for (const wider of data.flash_pixels) drawRing(c, place(frame.hip), data.hip_radius / unit + wider, data.snap_colour);
    return;
  }
}

const hasForceBar = () => live && data.full_force > 0;

function drawForceBar(c, width, height, force) {
  if (Math.min(width, height) < 150) return;
  const x = width - 33, top = 0.4 * height, bottom = height - 26, part = clamp(force / data.full_force, 0, 1);
  c.fillStyle = "#dee0e6";
  c.fillRect(x, top, 14, bottom - top);
  c.fillStyle = data.force_colour;
  c.fillRect(x, bottom - part * (bottom - top), 14, part * (bottom - top));
  c.fillStyle = kInk;
  c.textAlign = "right";
  c.fillText(`${threeDigits(data.full_force)} N`, width - 8, top - 10);
  c.fillText("0", width - 23, bottom + 10);
  c.textAlign = "left";
}

function drawLegend() {
  const [c, width, height] = context(element("legend"), ...pictureSize());
  const scale = letterScale(), unit = pixel() * scale;
  const place = (v) => inPicture(v).map((x) => x / scale);
  c.fillStyle = kInk;
  drawScaleBar(c, width, height, unit);
  const longest = Math.min(data.axes.longest, data.axes.part * Math.min(width, height));
  drawAxes(c, longest + 26, height - longest - 40, longest);
  if (frames.length === 0) return;
  const frame = frames[shown];
  nameTurned(c, frame, place);
  drawHand(c, frame, place);
  drawFlash(c, frame, place, unit);
  if (hasForceBar()) drawForceBar(c, width, height, frame.size);
}
