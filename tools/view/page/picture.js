// The picture of a frame: the shapes of libcore/scene/drawing.cpp, drawn by WebGL.

let gl = null;       // null without WebGL
let shapes = null;
let sticks = false;

/// Makes the canvas, if the browser has WebGL, and says so if not.
function buildPicture() {
  const canvas = document.createElement("canvas");
  gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) {
    say("This browser has no WebGL, so that there is no picture here: only the curves and the numbers.");
    return;
  }
  element("scene").prepend(canvas);
  canvas.addEventListener("webglcontextlost", (e) => e.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => { makeShapes(); drawSoon(); });
  makeShapes();
}

function makeShapes() {
  const balls = { ball: 4, tint: 3 }, columns = Math.ceil(Math.sqrt(Math.max(1, data.spheres.length)));
  shapes = {
    balls: makeShape(gl, makeProgram(gl, kBallVertex, kBallFragment), squareMesh(), balls),
    lights: makeShape(gl, makeProgram(gl, kLightVertex, kLightFragment), squareMesh(), balls),
    rods: makeShape(gl, makeProgram(gl, kRodVertex, kRodFragment), rodMesh(), { from: 4, to: 4, tint: 3 }),
    lines: makeShape(gl, makeProgram(gl, kLineVertex, kLineFragment), squareMesh(), { from: 3, to: 3 }),
    floor: makeShape(gl, makeProgram(gl, kFloorVertex, kFloorFragment), squareMesh(), { place: 4, dark: 1 }),
    tiles: [columns, Math.ceil(data.spheres.length / columns) || 1], light: gl.createFramebuffer(),
  };
  // The first for the occluders, the second for the light that they leave.
  const [, light] = [gl.NEAREST, gl.LINEAR].map((filter, unit) => {
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
    return texture;
  });
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R8, ...shapes.tiles.map((n) => kTile * n));
  gl.bindFramebuffer(gl.FRAMEBUFFER, shapes.light);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, light, 0);
  gl.activeTexture(gl.TEXTURE0);
  drawn = null;
}

const sphere = (frame, k) => Array.from(frame.centres.subarray(3 * k, 3 * k + 3));
const drawnRadius = (k) => (sticks ? data.ball_part : 1) * data.spheres[k][0];
const boxCorner = (c) => [0, 1, 2].map((a) => (c >> a & 1 ? data.high : data.low)[a]);

function boxEdges() {
  const edges = [];
  for (let c = 0; c < 8; ++c)
    for (const a of [1, 2, 4])
      if (!(c & a)) edges.push(...boxCorner(c), ...boxCorner(c | a));
  return edges;
}

/// The halves of the sticks between balls that do not touch, each in the colour of its end.
function sticksOf(frame) {
  const rods = [];
  for (const ends of frame.bonds) {
    const [from, to] = ends.map((k) => sphere(frame, k));
    const middle = plus(from, plus(to, from, -1), 0.5), radii = ends.map(drawnRadius);
    if (distance(from, to) < radii[0] + radii[1]) continue;
    const radius = data.stick_part / data.ball_part * Math.min(...radii);
    [from, to].forEach((end, n) => rods.push(...end, radius, ...middle, radius, ...data.spheres[ends[n]].slice(1)));
  }
  return rods;
}

/// The arrow, which begins outside the HIP.
function arrowOf(frame) {
  const [length, shaft, wide, head] = frame.arrow;
  if (!(length > 0) || !finite(frame.hip)) return [];
  const at = (t) => plus(frame.hip, frame.force, (data.hip_radius + t) / frame.size);
  const neck = at(length - head);
  return [...at(0), shaft, ...neck, shaft, ...data.force_rgb, ...neck, wide, ...at(length), 0, ...data.force_rgb];
}

/// For each ball the others that darken it most, as find_occluders() in render.cpp finds them, in a texture; and of each
/// ball the light that they leave to what is seen of it, in another.
function drawLights(places, balls, uniforms) {
  const most = data.most_occluders, texels = new Float32Array(4 * most * places.length);
  places.forEach(([k, at], i) => {
    const near = [];
    for (const [n, other] of places) {
      const away = distance(at, other), radius = drawnRadius(n);
      if (n !== k && away > 0 && away < data.light.reach * radius + drawnRadius(k)) near.push([-radius / away, n, ...other, radius]);
    }
    near.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    near.slice(0, most).forEach((one, n) => texels.set(one.slice(2), 4 * (most * i + n)));
  });
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, most, places.length, 0, gl.RGBA, gl.FLOAT, texels);
  gl.bindFramebuffer(gl.FRAMEBUFFER, shapes.light);
  gl.viewport(0, 0, ...shapes.tiles.map((n) => kTile * n));
  shapes.lights(balls, uniforms);
}

/// The spheres that touch the HIP from outside.
function touchedOf(places, hip) {
  if (places.some(([k, at]) => distance(at, hip) < data.spheres[k][0])) return [];
  return places.filter(([k, at]) => distance(at, hip) < data.touch * (data.spheres[k][0] + data.hip_radius));
}

function floorOf(balls) {
  const [x, y] = [0, 1].map((a) => (data.low[a] + data.high[a]) / 2);
  const shadows = balls.filter(([at]) => at[2] > data.low[2])
    .flatMap(([at, radius]) => [at[0], at[1], ...Array(2).fill(data.shadow_radii * radius), 1]);
  return [shadows, [x, y, data.high[0] - x, data.high[1] - y, 0]];
}

let drawn = null;  // what the picture depends on, when it was drawn last

/// Whether the picture that is there shows this frame: nothing is elsewhere by a part of a pixel.
function isDrawn(frame) {
  const before = drawn, tip = frame.size > 0 ? plus(frame.hip, frame.force, frame.arrow[0] / frame.size) : frame.hip;
  drawn = { look: JSON.stringify([view, sticks, ...pictureSize(), window.devicePixelRatio, data.hip_radius]), places: [...frame.hip, ...tip, ...frame.centres] };
  if (before === null || before.look !== drawn.look || before.places.length !== drawn.places.length) return false;
  const least = pixel() / 10;
  const same = drawn.places.every((x, i) => Math.abs(x - before.places[i]) <= least || (!Number.isFinite(x) && !Number.isFinite(before.places[i])));
  if (same) drawn = before;
  return same;
}

function drawPicture(frame) {
  if (isDrawn(frame)) return;
  const near = view.axes[2], [width, height] = pictureSize(), unit = pixel();
  const dots = window.devicePixelRatio * sharpness(), size = setSize(gl.canvas, width, height, dots);

  const places = data.spheres.map((_, k) => [k, sphere(frame, k)]).filter(([, at]) => finite(at));
  const deep = [...places.map(([, at]) => at), ...[0, 1, 2, 3, 4, 5, 6, 7].map(boxCorner)].map((at) => dot(near, plus(at, view.centre, -1)));
  const farthest = deep.reduce((a, b) => Math.max(a, Math.abs(b)), 0) + 4 * data.extent[0] + 4 * data.extent[1];
  const uniforms = {
    axes: view.axes.flat(), centre: view.centre, low: data.low, high: data.high, window: size, tiles: shapes.tiles,
    scale: [2 / (unit * width), 2 / (unit * height), -1 / farthest], dot_size: unit / dots,
    depths: [deep.reduce((a, b) => Math.max(a, b)), deep.reduce((a, b) => Math.min(a, b))],
    opacity: 1, rim: 0, edge: 0, occluded: false,
  };
  const balls = places.flatMap(([k, at]) => [...at, drawnRadius(k), ...data.spheres[k].slice(1)]);
  const rods = sticksOf(frame), arrow = arrowOf(frame);
  const occluded = places.length > 0 && places.length <= data.most_shaded;
  gl.disable(gl.DEPTH_TEST);
  gl.disable(gl.BLEND);
  if (occluded) drawLights(places, balls, uniforms);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, ...size);
  gl.clearColor(1, 1, 1, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);

  const rim = unit * letterScale();
  gl.enable(gl.BLEND);
  const hasHip = finite(frame.hip);
  const shadows = places.map(([k, at]) => [at, drawnRadius(k)]);
  if (hasHip) shadows.push([frame.hip, data.hip_radius]);
  if (near[2] > 0) {  // first what all shadows leave, then the floor's light with its part of that
    const [dark, floor] = floorOf(shadows), part = data.light.floor_light * data.light.shadow;
    gl.blendFunc(gl.DST_COLOR, gl.ZERO);
    shapes.floor(dark, uniforms);
    gl.blendColor(part, part, part, 1);
    gl.blendFunc(gl.ONE, gl.CONSTANT_COLOR);
    shapes.floor(floor, uniforms);
  }
  gl.disable(gl.BLEND);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LESS);
  gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  shapes.balls(balls, { ...uniforms, rim, occluded });
  gl.enable(gl.CULL_FACE);
  shapes.rods(rods, { ...uniforms, rim });
  shapes.rods(arrow, { ...uniforms, rim: 1.5 * rim, edge: 1 });
  shapes.rods([...rods, ...arrow], uniforms);
  gl.disable(gl.CULL_FACE);
  gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  shapes.lines(boxEdges(), { ...uniforms, rim: data.line_pixels * dots * letterScale() });
  if (!hasHip) return;
  gl.depthMask(false);
  const touched = sticks && frame.size > 0 ? touchedOf(places, frame.hip) : [];
  shapes.balls(touched.flatMap(([k, at]) => [...at, ...data.spheres[k]]), { ...uniforms, opacity: data.touched_opacity, depths: [0, 0] });
  // The HIP, and fainter what of it is behind something.
  for (const [test, opacity] of [[gl.GREATER, data.hidden_opacity], [gl.LESS, data.hip_opacity]]) {
    gl.depthFunc(test);
    shapes.balls([...frame.hip, data.hip_radius, ...data.hip_rgb], { ...uniforms, opacity, depths: [0, 0] });
  }
  gl.depthMask(true);
}
