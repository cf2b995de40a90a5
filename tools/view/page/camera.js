// The camera: what of the model's space is where in the picture. At first it is the one that view computed
// (fit_extent() in libcore/scene/drawing.hpp); then it is turned, moved and zoomed here.
// Vectors are arrays of three numbers.

const element = (id) => document.getElementById(id);
const clamp = (x, low, high) => Math.max(low, Math.min(high, x));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const distance = (a, b) => Math.hypot(...plus(a, b, -1));
const finite = (v) => v.every(Number.isFinite);

let view = null;  // azimuth and elevation in degrees; the centre; the zoom

function fit() {
  const { azimuth, elevation, centre } = data;
  view = { azimuth, elevation, centre, zoom: 1 };
}

/// Of the picture, in the model's space.
function axes() {
  const [a, e] = [view.azimuth, view.elevation].map((degrees) => degrees * Math.PI / 180);
  const [sine, cosine] = [Math.sin(a), Math.cos(a)];
  return {
    right: [cosine, sine, 0],
    up: [-sine * Math.sin(e), cosine * Math.sin(e), Math.cos(e)],
    near: [sine * Math.cos(e), -cosine * Math.cos(e), Math.sin(e)],
  };
}

/// Pixels of the page.
const pictureSize = () => [element("scene").clientWidth, element("scene").clientHeight];

/// How much larger letters and lines are than on a small screen: page.html has the rule.
const letterScale = () => parseFloat(getComputedStyle(document.documentElement).fontSize) / 13;

/// Gives a canvas a size in pixels of the page, and returns the size in pixels of the screen.
function setSize(canvas, width, height) {
  const size = [width, height].map((x) => Math.round(window.devicePixelRatio * x));
  if (canvas.width !== size[0] || canvas.height !== size[1]) {
    Object.assign(canvas, { width: size[0], height: size[1] });
    Object.assign(canvas.style, { width: width + "px", height: height + "px" });
  }
  return size;
}

/// The size of a pixel in the model's unit.
function pixel() {
  const [width, height] = pictureSize();
  const beside = hasForceBar() ? 80 * letterScale() : 0;  // half of it for the bar
  return 2 * Math.max(data.extent[0] / Math.max(width - beside, 40), data.extent[1] / height) / view.zoom;
}

/// Where a place of the model's space is in the picture, in pixels.
function inPicture(v) {
  const { right, up } = axes(), [width, height] = pictureSize();
  const at = plus(v, view.centre, -1), unit = pixel();
  return [width / 2 + dot(right, at) / unit, height / 2 - dot(up, at) / unit];
}

function turnView(right, down) {
  view.azimuth -= 0.4 * right;
  view.elevation = clamp(view.elevation + 0.4 * down, -90, 90);
  drawSoon();
}

function moveView(right, down) {
  const of = axes(), unit = pixel();
  view.centre = plus(plus(view.centre, of.up, unit * down), of.right, -unit * right);
  drawSoon();
}

function zoomView(by) {
  view.zoom = clamp(view.zoom * by, 0.01, 1000);
  drawSoon();
}
