// The camera: what of the model's space is where in the picture. At first it is the one that view computed
// (fit_camera() in libcore/scene/drawing.hpp); then it is turned, moved and zoomed here.
// Vectors are arrays of three numbers.

const element = (id) => document.getElementById(id);
const clamp = (x, low, high) => Math.max(low, Math.min(high, x));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const distance = (a, b) => Math.hypot(...plus(a, b, -1));
const finite = (v) => v.every(Number.isFinite);

let view = null;  // the picture's axes in the model's space: right, up, near; its centre; the zoom

function fit() {
  view = { axes: data.axes, centre: data.centre, zoom: 1 };
}

/// Pixels of the page.
const pictureSize = () => [element("scene").clientWidth, element("scene").clientHeight];

/// How much larger letters and lines are than on a small screen: page.html has the rule.
const letterScale = () => parseFloat(getComputedStyle(document.documentElement).fontSize) / 13;

/// Gives a canvas a size in pixels of the page, and returns how many pixels it has itself: so many for one of the page.
function setSize(canvas, width, height, dots = window.devicePixelRatio) {
  const size = [width, height].map((x) => Math.round(dots * x));
  if (canvas.width !== size[0] || canvas.height !== size[1]) Object.assign(canvas, { width: size[0], height: size[1] });
  Object.assign(canvas.style, { width: width + "px", height: height + "px" });
  return size;
}

/// The size of a pixel in the model's unit. The bar of the force stands at the right, and the names of torsions beside
/// the model where there are no strips.
function pixel() {
  const [width, height] = pictureSize(), scale = letterScale(), [right, up, spheres] = data.extent;
  const bare = Math.max(width - (hasForceBar() ? 80 * scale : 0), 40);
  const open = Math.max(height - (data.own ? Math.min(76 * scale, height / 5) : 0), 40);  // between the sentence above and the scale below
  const names = data.own ? 0 : Math.min(scale * data.legend.names_width, data.legend.names_part * bare);
  return 2 * Math.max(right / bare, up / open, spheres / (bare - 2 * names)) / view.zoom;
}

/// Where a place of the model's space is in the picture, in pixels.
function inPicture(v) {
  const [right, up] = view.axes, [width, height] = pictureSize();
  const at = plus(v, view.centre, -1), unit = pixel();
  return [width / 2 + dot(right, at) / unit, height / 2 - dot(up, at) / unit];
}

/// Around the model's z, and up or down until one looks along it; in pixels.
function turnView(right, down) {
  const [around, over] = [-right, down].map((pixels) => 0.4 * pixels * Math.PI / 180);
  const mix = (a, b, angle) => a.map((x, i) => Math.cos(angle) * x + Math.sin(angle) * b[i]);
  const [side, up, near] = view.axes.map(([x, y, z]) => [...mix([x, y], [-y, x], around), z]);
  const higher = mix(up, near, -over);
  view.axes = higher[2] < 0 ? [side, up, near] : [side, higher, mix(near, up, over)];
  drawSoon();
}

function moveView(right, down) {
  const [side, up] = view.axes, unit = pixel();
  view.centre = plus(plus(view.centre, up, unit * down), side, -unit * right);
  drawSoon();
}

function zoomView(by) {
  view.zoom = clamp(view.zoom * by, 0.01, 1000);
  drawSoon();
}
