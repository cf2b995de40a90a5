// The curves of force and energy below the picture, and the line of numbers.

const kCurveSeconds = 10;  // of a live page

const threeDigits = (x) => parseFloat(x.toPrecision(3)).toString();

/// The frames of the curves: all of a file, the last seconds of a live page; and the times at both ends.
function curveFrames() {
  const end = frames[frames.length - 1].time;
  if (!live) return [frames, frames[0].time, end];
  return [frames.filter((frame) => frame.time >= end - kCurveSeconds), end - kCurveSeconds, end];
}

/// Multiples of 1, 2 or 5 times a power of ten from low to high, at most so many.
function ticks(low, high, most) {
  const least = (high - low) / most, power = Math.pow(10, Math.floor(Math.log10(least)));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((s) => s >= least) || 1;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && found.length <= most; ++k)
    found.push([k * step, (k * step).toFixed(clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 12))]);
  return found;
}

/// From the lowest to the highest value, with some room; at least a hundredth of the largest, since what is smaller is
/// noise, and from 0 to `least` on for what has no sign.
function extent(values, least) {
  const low = least ? 0 : values.reduce((a, b) => Math.min(a, b), Infinity);
  const high = values.reduce((a, b) => Math.max(a, b), low);
  const span = Math.max(high - low, least || 0.01 * Math.max(Math.abs(low), Math.abs(high)) || 1);
  return [least ? 0 : low - 0.07 * span, low + 1.07 * span];
}

/// Short, and with as many digits as the step between two ticks needs.
function tickText(v, text, step) {
  if (v === 0) return "0";
  if (text.length <= 6) return text;
  return v.toExponential(clamp(Math.floor(Math.log10(Math.abs(v))) - Math.floor(Math.log10(step) + 1e-9), 0, 6));
}

/// The names above a plot, each in its colour.
function drawNames(c, x, y, names) {
  for (const [text, colour] of names) {
    c.fillStyle = colour;
    c.fillText(text, x, y);
    x += c.measureText(text).width + 16;
  }
}

/// A cubic through the places that never goes beyond two neighbours (Steffen, Astron. Astrophys. 239, 1990), broken where a
/// place is not finite, and straight where the model snapped.
function strokeCurve(c, places, colour, dashes = []) {
  const rise = (k) => (k > 0 && k < places.length && !places[k][2] ? (places[k][1] - places[k - 1][1]) / (places[k][0] - places[k - 1][0]) : NaN);
  const slope = (k) => {
    const [a, b] = [rise(k), rise(k + 1)];
    if (!Number.isFinite(a + b)) return Number.isFinite(a) ? a : b;
    const before = places[k][0] - places[k - 1][0], after = places[k + 1][0] - places[k][0];
    return (Math.sign(a) + Math.sign(b)) * Math.min(Math.abs(a), Math.abs(b), Math.abs(a * after + b * before) / (before + after) / 2);
  };
  Object.assign(c, { strokeStyle: colour, lineWidth: 1.5, lineJoin: "round" });
  c.setLineDash(dashes);
  c.beginPath();
  places.forEach(([x, y, snapped], k) => {
    if (!Number.isFinite(y)) return;
    const [left, above] = places[k - 1] ?? [];
    if (!Number.isFinite(above)) c.moveTo(x, y);
    else if (snapped || x === left) c.lineTo(x, y);
    else c.bezierCurveTo(left + (x - left) / 3, above + slope(k - 1) * (x - left) / 3, x - (x - left) / 3, y - slope(k) * (x - left) / 3, x, y);
  });
  c.stroke();
  c.setLineDash([]);
}

/// @param lines of each its value in a frame, its colour and its dashes
function drawPlot(c, { left, right, top, bottom }, list, at, lines, least) {
  const real = lines.flatMap(([value]) => list.map(value)).filter(Number.isFinite);
  const [low, high] = extent(real, least);
  const y = (v) => (Number.isFinite(v) ? bottom - 1 - (bottom - top - 2) * (v - low) / (high - low) : NaN);
  c.fillStyle = "#fff";
  c.fillRect(left, top, right - left, bottom - top);
  c.fillStyle = data.ink;
  c.textAlign = "right";
  const marks = ticks(low, high, clamp(Math.floor((bottom - top) / 14), 1, 3));
  for (const [v, text] of marks) {
    strokeLines(c, [[[left - 4, y(v)], [left, y(v)]]], data.ink, 1);
    c.fillText(tickText(v, text, marks.length > 1 ? marks[1][0] - marks[0][0] : high - low), left - 6, y(v));
  }
  c.textAlign = "left";
  strokeLines(c, [[[left, top], [left, bottom], [right, bottom]]], data.ink, 1);
  strokeLines(c, list.filter((frame) => frame.snapped).map(({ time }) => [[at(time), top], [at(time), bottom]]), data.snap_colour, 1);
  for (const [value, colour, dashes] of lines)
    strokeCurve(c, list.map((frame) => [at(frame.time), y(value(frame)), frame.snapped]), colour, dashes);
  const now = at(frames[shown].time);
  strokeLines(c, [[[now, top], [now, bottom]]], data.ink, 1);
}

function drawCurves() {
  const { clientWidth, clientHeight } = element("curves").parentElement;
  const [c, width, height] = context(element("curves"), clientWidth, clientHeight);
  const [list, from, to] = curveFrames();
  const left = 46, right = width - 1, bottomRow = 16, nameRow = 15;
  const at = (t) => left + (right - left) * (t - from) / (to - from || 1);
  const snap = list.some((frame) => frame.snapped) ? [["| snap", data.snap_colour]] : [];
  const plots = [{ names: [["force / N", data.force_colour], ...snap], lines: [[(frame) => frame.size, data.force_colour]] }];
  if (list.some((frame) => Number.isFinite(frame.energy))) {
    plots.push({ names: [[data.energy_label, data.energy_colour]], lines: [[(frame) => frame.energy, data.energy_colour]] });
    if (list.some((frame) => Number.isFinite(frame.own))) {
      plots[1].names.push(["- - of the model alone", data.ink]);
      plots[1].lines.push([(frame) => frame.own, data.ink, [4, 4]]);
    }
  }
  const each = (height - bottomRow) / plots.length;
  plots.forEach(({ names, lines }, k) => {
    drawPlot(c, { left, right, top: k * each + nameRow, bottom: (k + 1) * each - 3 }, list, at, lines, k === 0 ? data.full_force / 20 || 1e-6 : 0);
    drawNames(c, left, k * each + nameRow / 2, names);
  });
  c.fillStyle = data.ink;
  c.textAlign = "center";
  for (const [t, text] of ticks(Math.max(from, 0), to, Math.max(1, (right - at(Math.max(from, 0))) / 90))) {
    strokeLines(c, [[[at(t), height - bottomRow - 3], [at(t), height - bottomRow]]], data.ink, 1);
    if (at(t) < right - 30) c.fillText(text, at(t), height - bottomRow / 2);
  }
  c.textAlign = "right";
  c.fillText("t / s", right, height - bottomRow / 2);
}

function drawStatus() {
  const snapped = (to) => frames.slice(0, to).filter((frame) => frame.snapped).length;
  const count = live ? snaps : `${snapped(shown + 1)} of ${snapped()}`;
  element("status").textContent = `${frames[shown].status}   snaps ${count}${ended ? "   ended" : ""}`;
}
