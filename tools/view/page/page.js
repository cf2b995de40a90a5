// The page of view --html. `data` is the play; what it holds is in tools/view/page.cpp. The picture is that of
// the other viewers: the light is that of shade() in libcore/scene/render.cpp, the fit that of fit_camera().
"use strict";

const numbers = (text, type) => new type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
const times = numbers(data.times, Float64Array);
const hips = numbers(data.hips, Float32Array);
const forces = numbers(data.forces, Float32Array);
const energies = numbers(data.energies, Float32Array);
const ownEnergies = numbers(data.own_energies, Float32Array);
const turned = numbers(data.turned, Float32Array);
const centres = numbers(data.centres, Float32Array);
const last = times.length - 1;
const sizes = Array.from(times, (_, i) => Math.hypot(forces[3 * i], forces[3 * i + 1], forces[3 * i + 2]));
const element = (id) => document.getElementById(id);
const vector = (list, i) => new THREE.Vector3(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
const finite = (v) => Number.isFinite(v.x + v.y + v.z);

document.title = data.model + " - hapgrid";
let shown = 0;           // the frame
let playing = null;      // since when, and from which time of play on
let view = null;         // azimuth, elevation in degrees; centre; half: units from the middle to the nearer edges; free:
                         // whether the reader chose that size
let sticks = data.sticks;

// --- The scene ----------------------------------------------------------------------------------------------

const scene = new THREE.Scene();
const camera = new THREE.OrthographicCamera();
const renderer = new THREE.WebGLRenderer({ antialias: true });
renderer.setPixelRatio(window.devicePixelRatio);
renderer.setClearColor(0xffffff);
element("scene").appendChild(renderer.domElement);
const legend = document.createElement("canvas");
legend.id = "legend";
element("scene").appendChild(legend);

function paint(colour, opacity, depths = {}) {
  return new THREE.ShaderMaterial({
    ...depths,
    transparent: opacity < 1,
    uniforms: { colour: { value: new THREE.Vector3(...colour) }, opacity: { value: opacity } },
    vertexShader: `
      varying vec3 n;
      void main() {
        n = normalMatrix * normal;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `
      uniform vec3 colour;
      uniform float opacity;
      varying vec3 n;
      void main() {
        vec3 normal = normalize(n);
        float diffuse = max(0.0, dot(normal, vec3(-0.4243, 0.5657, 0.7071)));
        float shine = 0.25 * pow(max(0.0, dot(normal, vec3(-0.2297, 0.3062, 0.9239))), 40.0);
        float rim = min(1.0, 0.45 + 1.6 * normal.z);
        gl_FragColor = vec4(min(vec3(1.0), (0.4 + 0.6 * diffuse) * rim * colour + shine), opacity);
      }`,
  });
}

function add(shape, material) {
  const mesh = new THREE.Mesh(shape, material);
  scene.add(mesh);
  return mesh;
}

const ball = new THREE.SphereBufferGeometry(1, 40, 24);
const spheres = data.spheres.map(([, ...colour]) => add(ball, paint(colour, 1)));
const stick = new THREE.CylinderBufferGeometry(1, 1, 1, 24);
let halves = [];  // of sticks, each from an end to the middle, in the colour of that end
const blue = [0.15, 0.35, 0.95];
// The second is what stands behind the molecule, which fades before it.
const hip = [add(ball, paint(blue, 0.6)),
             add(ball, paint(blue, 0.5, { depthFunc: THREE.GreaterDepth, depthWrite: false }))];
hip[1].renderOrder = -1;
for (const mesh of hip) mesh.scale.setScalar(data.hip_radius);
const red = paint([0.85, 0.1, 0.1], 1);
const shaft = add(new THREE.CylinderBufferGeometry(1, 1, 1, 24), red);
const head = add(new THREE.CylinderBufferGeometry(0, 1, 1, 24), red);
const low = new THREE.Vector3(...data.low);
const high = new THREE.Vector3(...data.high);
const box = new THREE.Box3Helper(new THREE.Box3(low, high), new THREE.Color(0.62, 0.65, 0.7));
scene.add(box);

function placeArrow(i) {
  const from = vector(hips, i);
  const way = vector(forces, i).multiplyScalar(data.newton);
  const length = way.length();
  const radius = data.hip_radius / 5;
  shaft.visible = head.visible = finite(from) && length > 0 && Number.isFinite(length);
  if (!shaft.visible) return;
  way.normalize();
  const tip = Math.min(6 * radius, length);
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
  for (const [mesh, at, wide, long] of [[shaft, (length - tip) / 2, radius, length - tip],
                                        [head, length - tip / 2, 2.5 * radius, tip]]) {
    mesh.position.copy(from).addScaledVector(way, at);
    mesh.quaternion.copy(turn);
    mesh.scale.set(wide, Math.max(long, 1e-9), wide);
  }
}

function placeRod(mesh, from, to, radius) {
  const way = to.clone().sub(from);
  const length = way.length();
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.normalize());
  mesh.scale.set(radius, Math.max(length, 1e-9), radius);
}

function placeSticks(i) {  // the sizes are those of libcore/scene/drawing.cpp, the bonds those of bonds.cpp
  for (const mesh of halves) scene.remove(mesh);
  halves = [];
  if (!sticks || spheres.length > 4096) return;
  const at = spheres.map((_, k) => vector(centres, i * spheres.length + k));
  for (let a = 0; a < at.length; ++a)
    for (let b = a + 1; b < at.length; ++b) {
      const [ra, rb] = [data.spheres[a][0], data.spheres[b][0]];
      if (!(at[a].distanceTo(at[b]) < 0.6 * (ra + rb))) continue;
      const middle = at[a].clone().add(at[b]).multiplyScalar(0.5);
      for (const end of [a, b]) {
        const mesh = add(stick, spheres[end].material);
        placeRod(mesh, at[end], middle, 0.12 * Math.min(ra, rb));
        halves.push(mesh);
      }
    }
}

function place(i) {
  spheres.forEach((mesh, k) => {
    const at = vector(centres, i * spheres.length + k);
    mesh.visible = finite(at);
    mesh.scale.setScalar(Math.max((sticks ? 0.25 : 1) * data.spheres[k][0], 1e-9));
    if (mesh.visible) mesh.position.copy(at);
  });
  placeSticks(i);
  for (const mesh of hip) {
    mesh.visible = finite(vector(hips, i));
    if (mesh.visible) mesh.position.copy(vector(hips, i));
  }
  placeArrow(i);
}

// --- The camera ---------------------------------------------------------------------------------------------

function axes() {  // of the picture, in the model's space
  const a = THREE.Math.degToRad(view.azimuth), e = THREE.Math.degToRad(view.elevation);
  return {
    right: new THREE.Vector3(Math.cos(a), Math.sin(a), 0),
    near: new THREE.Vector3(Math.sin(a) * Math.cos(e), -Math.cos(a) * Math.cos(e), Math.sin(e)),
    up: new THREE.Vector3(-Math.sin(a) * Math.sin(e), Math.cos(a) * Math.sin(e), Math.cos(e)),
  };
}

/// What is seen of a frame: the spheres, each larger by `room`.
function seeSpheres(see, i, room) {
  data.spheres.forEach(([radius], k) => see(vector(centres, i * spheres.length + k), radius + room));
}

function fit() {  // as fit_model() does
  view = { azimuth: data.azimuth, elevation: data.elevation, centre: new THREE.Vector3(), half: 1, free: false };
  const { right, up, near } = axes();
  const seen = new THREE.Box3();
  const see = (v, radius) => {
    if (!finite(v)) return;
    const at = new THREE.Vector3(right.dot(v), up.dot(v), near.dot(v));
    for (const r of [-radius, radius]) seen.expandByPoint(at.clone().addScalar(r));
  };
  seeSpheres(see, shown, data.hip_radius);
  if (seen.isEmpty())
    for (let c = 0; c < 8; ++c)
      see(new THREE.Vector3(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z), 0);
  const [width, height] = [element("scene").clientWidth, element("scene").clientHeight];
  const size = seen.getSize(new THREE.Vector3());
  const shorter = Math.min(width, height);
  view.half = 0.53 * Math.max(size.x * shorter / width, size.y * shorter / height) || 1;
  const middle = seen.getCenter(new THREE.Vector3());
  view.centre.addScaledVector(right, middle.x).addScaledVector(up, middle.y).addScaledVector(near, middle.z);
}

/// The half width with room for the HIP and the model as they are now, and for the longest arrow since fit().
function halfWidth() {
  if (view.free) return view.half;
  const { right, up } = axes();
  const [width, height] = [element("scene").clientWidth, element("scene").clientHeight];
  const shorter = Math.min(width, height);
  let most = 0;
  const see = (v, radius) => {
    if (!finite(v)) return;
    const from = v.clone().sub(view.centre);
    most = Math.max(most, (Math.abs(right.dot(from)) + radius) * shorter / width,
                    (Math.abs(up.dot(from)) + radius) * shorter / height);
  };
  see(vector(hips, shown).addScaledVector(vector(forces, shown), data.newton), data.hip_radius / 2);
  view.half = Math.max(view.half, 1.06 * most);
  most = 0;
  seeSpheres(see, shown, 0);
  see(vector(hips, shown), data.hip_radius);
  return Math.max(view.half, 1.06 * most);
}

/// The reader moves or sizes the picture: from now on it keeps its size.
function free() {
  view.half = halfWidth();
  view.free = true;
}

function aim() {
  const [width, height] = [element("scene").clientWidth, element("scene").clientHeight];
  const { up, near } = axes();
  const half = halfWidth();
  const unit = 2 * half / Math.min(width, height);  // of a pixel
  const far = 4 * (half + high.distanceTo(low)) + view.centre.distanceTo(low);
  camera.left = -(camera.right = unit * width / 2);
  camera.bottom = -(camera.top = unit * height / 2);
  camera.near = 0;
  camera.far = 2 * far;
  camera.up.copy(up);
  camera.position.copy(view.centre).addScaledVector(near, far);
  camera.lookAt(view.centre);
  camera.updateProjectionMatrix();
  renderer.setSize(width, height);
  drawLegend(width, height, unit);
}

function context(canvas, width, height) {  // where a unit is a pixel of the page
  const ratio = window.devicePixelRatio;
  canvas.width = ratio * width;
  canvas.height = ratio * height;
  canvas.style.width = width + "px";
  canvas.style.height = height + "px";
  const c = canvas.getContext("2d");
  c.scale(ratio, ratio);
  c.font = "11px sans-serif";
  c.textBaseline = "middle";
  return c;
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `most`.
function roundLength(most) {
  const power = Math.pow(10, Math.floor(Math.log10(most)));
  return power * [5, 2, 1].find((digit) => digit * power <= most || digit === 1);
}

function withUnit(length) {
  return parseFloat(length.toPrecision(3)) + " " + data.length_unit;
}

/// From a place of the picture, each with its name and how long it is.
function drawAxes(c, x, y, length, unit) {
  const { right, up } = axes();
  for (const axis of ["x", "y", "z"]) {
    const shown = Math.max(Math.hypot(right[axis], up[axis]), 1e-9);
    const along = right[axis] / shown, down = -up[axis] / shown, end = length / unit * shown;
    c.moveTo(x, y);
    c.lineTo(x + end * along, y + end * down);
    c.moveTo(x + end * along + 2 * down, y + end * down - 2 * along);
    c.lineTo(x + end * along - 2 * down, y + end * down + 2 * along);
    const text = axis + " " + (data.length_unit.length > 2 ? parseFloat(length.toPrecision(3)) : withUnit(length));
    c.fillText(text, x + (end + 6) * along - (0.5 - 0.5 * along) * c.measureText(text).width, y + (end + 6) * down + 4 * Math.sign(down) * down * down);
  }
}

function drawLegend(width, height, unit) {  // as libcore/scene/legend.cpp does
  const c = context(legend, width, height);
  const length = roundLength(0.25 * width * unit);
  const bar = length / unit, left = 10, bottom = height - 10;
  c.strokeStyle = c.fillStyle = "#292b33";
  c.lineWidth = 1.2;
  c.beginPath();
  c.moveTo(left, bottom - 3); c.lineTo(left, bottom + 3);
  c.moveTo(left, bottom); c.lineTo(left + bar, bottom);
  c.moveTo(left + bar, bottom - 3); c.lineTo(left + bar, bottom + 3);
  c.fillText(withUnit(length), left + bar + 5, bottom);
  const longest = Math.min(60, 0.16 * Math.min(width, height));
  drawAxes(c, left + longest + 16, bottom - longest - 24, roundLength(longest * unit), unit);
  c.stroke();
  nameTurned(c, width, height, unit);
}

function turnedText(k) {
  const degrees = turned[shown * data.torsions.length + k];
  return `${data.torsions[k][0]} ${degrees < 0 ? "" : "+"}${degrees.toFixed(0)}°`;
}

/// The torsions that have turned since the beginning.
function whatTurned() {
  return data.torsions.map((_, k) => k)
    .filter((k) => Math.abs(turned[shown * data.torsions.length + k]) >= data.least_turn);
}

function nameTurned(c, width, height, unit) {  // each at the middle of its bond
  const { right, up } = axes();
  c.textAlign = "center";
  for (const k of whatTurned()) {
    const [, a, b] = data.torsions[k];
    const at = vector(centres, shown * spheres.length + a).add(vector(centres, shown * spheres.length + b))
      .multiplyScalar(0.5).sub(view.centre);
    const [x, y] = [width / 2 + right.dot(at) / unit, height / 2 - up.dot(at) / unit];
    const wide = c.measureText(turnedText(k)).width + 8;
    c.fillStyle = "#fff";
    c.fillRect(x - wide / 2, y - 8, wide, 16);
    c.fillStyle = "#292b33";
    c.fillText(turnedText(k), x, y);
  }
  c.textAlign = "left";
}

// --- Force and energy ---------------------------------------------------------------------------------------

const round = (x) => (Number.isFinite(x) ? parseFloat(x.toPrecision(3)) : "");

function drawCurves() {
  const width = element("below").clientWidth - 16, height = 126, left = 64, bottomRow = 12;
  const c = context(element("curves"), width, height);
  const at = (t) => left + (width - left - 1) * (t - times[0]) / (times[last] - times[0] || 1);
  const energy = energies.some(Number.isFinite);
  const curves = [["force / N", "#d91a1a", sizes]];
  if (energy) curves.push([data.energy_label, "#1e5abe", energies]);
  const each = (height - bottomRow) / curves.length;
  curves.forEach(([name, colour, values], k) => {
    const top = k * each + 4, bottom = (k + 1) * each - 4;
    const both = k === 0 ? [values] : [values, ownEnergies];
    const real = both.flatMap((list) => Array.from(list)).filter(Number.isFinite);
    const least = k === 0 ? 0 : real.reduce((a, b) => Math.min(a, b));
    const most = real.reduce((a, b) => Math.max(a, b), least);
    const y = (v) => bottom - 1 - (bottom - top - 2) * (v - least) / (most - least || 1);
    c.fillStyle = "#fff";
    c.fillRect(left, top, width - left, bottom - top);
    c.fillStyle = "#f0961e";
    for (const i of data.snaps) c.fillRect(at(times[i]) - 1, top, 2, bottom - top);
    c.fillStyle = colour;
    // On two lines where it is long: the quantity, and its unit.
    const [quantity, ...unit] = name.split(" / ");
    const lines = name.length > 10 ? [quantity, "/ " + unit.join(" / ")] : [name];
    lines.forEach((line, n) => c.fillText(line, 0, (top + bottom) / 2 + 13 * (n - (lines.length - 1) / 2), left - 4));
    c.fillStyle = "#282c34";
    c.textAlign = "right";
    c.fillText(round(most), left - 4, top + 5);
    c.fillText(round(least), left - 4, bottom - 5);
    c.textAlign = "left";
    c.lineWidth = 1.2;
    both.forEach((list, n) => {
      c.strokeStyle = n === 0 ? colour : "#008c64";
      c.beginPath();
      let drawn = false;  // a point that the next one is joined with
      list.forEach((v, i) => {
        if (Number.isFinite(v)) drawn ? c.lineTo(at(times[i]), y(v)) : c.moveTo(at(times[i]), y(v));
        drawn = Number.isFinite(v);
      });
      c.stroke();
    });
    if (k === 1 && ownEnergies.some(Number.isFinite)) {
      c.fillStyle = "#008c64";
      c.fillText("of the model alone", left + 4, top + 6);
    }
    c.fillStyle = "#282c34";
    c.fillRect(at(times[shown]) - 0.5, top, 1, bottom - top);
  });
  const row = height - bottomRow / 2;
  c.fillText(times[0].toFixed(2), left, row);
  c.textAlign = "center";
  c.fillText("t / s", (left + width) / 2, row);
  c.textAlign = "right";
  c.fillText(times[last].toFixed(2), width, row);
}

function drawStatus() {
  let text = `t ${times[shown].toFixed(2)} s   force ${round(sizes[shown])} N`;
  if (Number.isFinite(energies[shown])) text += `   energy ${round(energies[shown])} ${data.energy_unit}`;
  if (Number.isFinite(ownEnergies[shown])) text += `   model alone ${round(ownEnergies[shown])}`;
  text += whatTurned().map((k) => "   " + turnedText(k)).join("");
  text += `   snaps ${data.snaps.filter((i) => i <= shown).length} of ${data.snaps.length}`;
  element("status").textContent = text;
}

// --- What the reader does -----------------------------------------------------------------------------------

function draw() {
  if (last < 0) return;
  place(shown);
  aim();
  renderer.render(scene, camera);
  element("time").value = shown;
  drawCurves();
  drawStatus();
}

/// The frame nearest to a time, the earlier of two.
function nearest(t) {
  let from = 0, to = last;
  while (from < to) {
    const middle = (from + to) >> 1;
    if (times[middle + 1] - t < t - times[middle]) from = middle + 1;
    else to = middle;
  }
  return from;
}

function setPlaying(yes) {
  if (yes && shown === last) shown = 0;
  playing = yes ? { since: performance.now(), from: times[shown] } : null;
  element("play").textContent = yes ? "pause" : "play";
  if (yes) requestAnimationFrame(step);
}

function step(now) {
  if (!playing) return;
  shown = nearest(playing.from + (now - playing.since) / 1000);
  draw();
  if (shown === last) setPlaying(false);
  else requestAnimationFrame(step);
}

function listen() {
  const area = element("scene");
  area.addEventListener("pointerdown", (e) => area.setPointerCapture(e.pointerId));
  area.addEventListener("contextmenu", (e) => e.preventDefault());
  area.addEventListener("pointermove", (e) => {
    if (!e.buttons) return;
    if (e.buttons === 1 && !e.shiftKey) {
      view.azimuth -= 0.4 * e.movementX;
      view.elevation = Math.max(-90, Math.min(90, view.elevation + 0.4 * e.movementY));
    } else {
      free();
      const { right, up } = axes();
      const unit = 2 * view.half / Math.min(area.clientWidth, area.clientHeight);
      view.centre.addScaledVector(up, unit * e.movementY).addScaledVector(right, -unit * e.movementX);
    }
    draw();
  });
  area.addEventListener("wheel", (e) => {
    free();
    view.half *= Math.pow(1.1, Math.sign(e.deltaY));
    draw();
    e.preventDefault();
  }, { passive: false });
  element("time").addEventListener("input", (e) => {
    setPlaying(false);
    shown = Number(e.target.value);
    draw();
  });
  element("play").addEventListener("click", () => setPlaying(!playing));
  window.addEventListener("keydown", (e) => {
    if (e.key === "r") fit();
    else if (e.key === "b") sticks = !sticks;
    else if (e.key === " ") setPlaying(!playing);
    else return;
    e.preventDefault();
    draw();
  });
  window.addEventListener("resize", draw);
  window.addEventListener("hashchange", goToHash);
}

/// page.html#t=2.5 shows that time of play.
function goToHash() {
  const t = parseFloat(location.hash.replace("#t=", ""));
  if (Number.isFinite(t)) shown = nearest(t);
  draw();
}

element("time").max = Math.max(0, last);
listen();
const wanted = parseFloat(location.hash.replace("#t=", ""));
if (Number.isFinite(wanted)) shown = nearest(wanted);
fit();
draw();
