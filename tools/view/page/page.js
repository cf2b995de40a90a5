// The page of view: `data` is the scene, and what it and a frame hold is in tools/view/page/page.cpp. In the file of
// view --html the frames are in it; the live page of view --web gets both by a WebSocket. The picture is that of
// view --png: what is computed of a scene comes from there, and here it is only drawn.
"use strict";

const element = (id) => document.getElementById(id);
// By set(), because the constructor takes NaN for 0.
const number3 = (list, k = 0) => new THREE.Vector3().set(list[3 * k], list[3 * k + 1], list[3 * k + 2]);
const centre = (frame, k) => number3(frame.centres, k);
const finite = (v) => Number.isFinite(v.x + v.y + v.z);
const clamp = (x, low, high) => Math.max(low, Math.min(high, x));

const frames = [];       // of a live page those of the last seconds
const kLiveSeconds = 20;
const kLiveBytes = 64e6;
const kFlashSeconds = 0.3;
const kCurveSeconds = 10;  // of a live page
let live = false;
let socket = null;
let ended = false;
let snaps = 0;           // of a live page, since it was opened
let shown = 0;           // the frame
let playing = null;      // of a file: since when, and from which time of play on; of a live page: whether it goes on
let view = null;         // azimuth, elevation in degrees; centre; half: units from the middle to the nearer edges
let sticks = false;
let turning = false;     // a drag turns the picture although there is a hand
let hand = null;         // where this page's hand is
let scene, camera, renderer, low, high, spheres = [], hip, shaft, head;
let halves = [];         // of sticks, each from an end to the middle, in the colour of that end

/// A frame of bytes: see append_frame() in page.cpp.
function decode(buffer) {
  const [time, jumps] = new Float64Array(buffer, 0, 2);
  const rest = new Float32Array(buffer, 16, 11);
  const turned = new Float32Array(buffer, 60, data.torsions.length);
  const centres = new Float32Array(buffer, 60 + 4 * turned.length, 3 * data.spheres.length);
  const bonds = new Uint16Array(buffer, 60 + 4 * (turned.length + centres.length));
  const before = frames[frames.length - 1];
  return { time, jumps, hip: rest.slice(0, 3), force: rest.slice(3, 6), size: Math.hypot(rest[3], rest[4], rest[5]),
           hand: rest.slice(6, 9), energy: rest[9], own: rest[10], turned, centres, bonds,
           snapped: before !== undefined && before.jumps !== jumps, bytes: buffer.byteLength };
}

// --- The scene ----------------------------------------------------------------------------------------------

const kMostOccluders = 16;
const depths = { value: null };  // of what is nearest and farthest to the camera, in its space

/// The light of render.cpp, whose formulas these are.
function paint(colour, opacity, { fog = true, ...more } = {}) {
  return new THREE.ShaderMaterial({
    ...more,
    transparent: opacity < 1,
    uniforms: {
      colour: { value: new THREE.Vector3(...colour) }, opacity: { value: opacity }, count: { value: 0 },
      others: { value: Array.from({ length: kMostOccluders }, () => new THREE.Vector4()) },
      depths: fog ? depths : { value: new THREE.Vector2() },
    },
    vertexShader: `
      varying vec3 n, world, at;
      varying float z;
      void main() {
        n = normalMatrix * normal;
        world = mat3(modelMatrix) * normal;
        at = (modelMatrix * vec4(position, 1.0)).xyz;
        vec4 seen = modelViewMatrix * vec4(position, 1.0);
        z = seen.z;
        gl_Position = projectionMatrix * seen;
      }`,
    fragmentShader: `
      uniform vec3 colour;
      uniform float opacity;
      uniform int count;
      uniform vec4 others[${kMostOccluders}];
      uniform vec2 depths;
      varying vec3 n, world, at;
      varying float z;
      float openLight() {
        float sum = 0.0;
        vec3 normal = normalize(world);
        for (int i = 0; i < ${kMostOccluders}; ++i) {
          if (i >= count) break;
          vec3 way = others[i].xyz - at;
          float away2 = dot(way, way);
          float size = min(1.0, others[i].w * others[i].w / away2) - 1.0 / 16.0;
          float above = max(0.0, 0.5 + 0.5 * dot(normal, way) / sqrt(away2));
          if (size > 0.0) sum += above * sqrt(above) * size;
        }
        return clamp(1.45 * pow(1.0 + 0.33 * sum / 16.0, -16.0), 0.12, 1.1);
      }
      void main() {
        vec3 normal = normalize(n);
        float diffuse = max(0.0, dot(normal, vec3(-0.4243, 0.5657, 0.7071)));
        float shine = 0.45 * pow(max(0.0, dot(normal, vec3(-0.2297, 0.3062, 0.9239))), 40.0);
        float light = count < 0 ? 1.0 : openLight();
        float deep = depths.x - depths.y;
        float fog = deep > 0.0 ? 0.35 * clamp((depths.x - z) / deep, 0.0, 1.0) : 0.0;
        gl_FragColor = vec4(mix(min(vec3(1.0), (0.62 + 0.42 * diffuse) * light * colour + shine), vec3(1.0), fog), opacity);
      }`,
  });
}

/// What lies behind a ball and is seen around it as a dark rim, where the next thing is much deeper.
function rim(colour, side) {
  const material = paint(colour.map((c) => 0.25 * c), 1, { side });
  material.fragmentShader = material.fragmentShader.replace(/gl_FragColor = .*;/, "gl_FragColor = vec4(mix(colour, vec3(1.0), fog), 1.0);");
  return material;
}

/// The floor, or a shadow on it.
function floorPaint(fragment, blending = {}) {
  return new THREE.ShaderMaterial({
    ...blending, depthTest: false, depthWrite: false, side: THREE.DoubleSide,
    uniforms: { low: { value: low }, high: { value: high } },
    vertexShader: `
      varying vec3 at, inside;
      void main() {
        inside = position;
        at = (modelMatrix * vec4(position, 1.0)).xyz;
        gl_Position = projectionMatrix * viewMatrix * vec4(at, 1.0);
      }`,
    fragmentShader: `
      uniform vec3 low, high;
      varying vec3 at, inside;
      void main() {
        if (at.x < low.x || at.y < low.y || at.x > high.x || at.y > high.y) discard;
        ${fragment}
      }`,
  });
}

function add(shape, material) {
  const mesh = new THREE.Mesh(shape, material);
  scene.add(mesh);
  return mesh;
}

let ball, stick, disc, floor, shadows = [], rims = [], box;

function build() {
  document.title = data.model + " - hapgrid";
  sticks = data.sticks;
  scene = new THREE.Scene();
  camera = new THREE.OrthographicCamera();
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true });
    renderer.setPixelRatio(window.devicePixelRatio);
    renderer.setClearColor(0xffffff);
    element("scene").appendChild(renderer.domElement);
  } catch (e) {
    renderer = null;
    say("This browser has no WebGL, so that there is no picture here: only the curves and the numbers.");
  }
  const legend = document.createElement("canvas");
  legend.id = "legend";
  element("scene").appendChild(legend);
  ball = new THREE.SphereBufferGeometry(1, 40, 24);
  stick = new THREE.CylinderBufferGeometry(1, 1, 1, 24);
  disc = new THREE.CircleBufferGeometry(1, 40);
  low = number3(data.low);
  high = number3(data.high);
  depths.value = new THREE.Vector2();
  spheres = data.spheres.map(([, ...colour]) => add(ball, paint(colour, 1)));
  rims = data.spheres.map(([, ...colour]) => add(disc, rim(colour, THREE.FrontSide)));
  // The second is what stands behind the molecule, which fades before it.
  hip = [add(ball, paint(data.hip_rgb, 0.6, { fog: false })),
         add(ball, paint(data.hip_rgb, 0.5, { fog: false, depthFunc: THREE.GreaterDepth, depthWrite: false }))];
  hip[1].renderOrder = -1;
  for (const mesh of hip) {
    mesh.scale.setScalar(data.hip_radius);
    mesh.material.uniforms.count.value = -1;
  }
  const force = paint(data.force_rgb, 1);
  force.uniforms.count.value = -1;
  shaft = add(new THREE.CylinderBufferGeometry(1, 1, 1, 24), force);
  head = add(new THREE.CylinderBufferGeometry(0, 1, 1, 24), force);
  box = new THREE.Box3Helper(new THREE.Box3(low, high), new THREE.Color(0.62, 0.65, 0.7));
  scene.add(box);
  floor = add(new THREE.PlaneBufferGeometry(high.x - low.x, high.y - low.y), floorPaint("gl_FragColor = vec4(vec3(0.97), 1.0);"));
  floor.position.set((low.x + high.x) / 2, (low.y + high.y) / 2, low.z);
  floor.renderOrder = -3;
  // Where shadows overlap there is the darkest.
  const shade = floorPaint("float u = 1.0 - dot(inside, inside); gl_FragColor = vec4(vec3(0.97 * (1.0 - 0.3 * u * u)), 1.0);",
    { blending: THREE.CustomBlending, blendEquation: THREE.MinEquation, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor });
  shadows = [...data.spheres, 0].map(() => add(disc, shade));  // the last is that of the HIP
  for (const mesh of shadows) mesh.renderOrder = -2;
}

/// The force begins outside the HIP.
function placeArrow(frame) {
  const from = number3(frame.hip);
  const length = frame.size * data.newton;
  shaft.visible = head.visible = finite(from) && length > 0 && Number.isFinite(length);
  if (!shaft.visible) return;
  const way = number3(frame.force).normalize();
  const [thin, wide, long] = data.arrow_parts.map((part, i) => Math.min(part * length, data.arrow_most[i] * data.hip_radius));
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
  for (const [mesh, at, radius, size] of [[shaft, (length - long) / 2, thin, length - long],
                                          [head, length - long / 2, wide, long]]) {
    mesh.position.copy(from).addScaledVector(way, data.hip_radius + at);
    mesh.quaternion.copy(turn);
    mesh.scale.set(radius, Math.max(size, 1e-9), radius);
  }
}

function placeRod(mesh, from, to, radius) {
  const way = to.clone().sub(from);
  const length = way.length();
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.normalize());
  mesh.scale.set(radius, Math.max(length, 1e-9), radius);
}

function placeSticks(frame) {
  for (const mesh of halves) scene.remove(mesh);
  halves = [];
  if (!sticks) return;
  const { near } = axes(), unit = pixel();
  for (let k = 0; k < frame.bonds.length; k += 2) {
    const pair = [frame.bonds[k], frame.bonds[k + 1]];
    const [from, to] = pair.map((end) => centre(frame, end));
    const middle = from.clone().add(to).multiplyScalar(0.5);
    const radius = data.stick_part * Math.min(data.spheres[pair[0]][0], data.spheres[pair[1]][0]);
    [from, to].forEach((at, n) => {
      const colour = data.spheres[pair[n]].slice(1);
      const plain = paint(colour, 1);
      plain.uniforms.count.value = -1;
      const meshes = [add(stick, plain), add(stick, rim(colour, THREE.BackSide))];
      placeRod(meshes[0], at, middle, radius);
      placeRod(meshes[1], at, middle, radius + unit);
      meshes[1].position.addScaledVector(near, -0.35 * radius);
      halves.push(...meshes);
    });
  }
}

const drawnRadius = (k) => (sticks ? data.ball_part : 1) * data.spheres[k][0];

/// For each sphere the others that darken it most: as find_occluders() in render.cpp.
function placeOccluders(frame) {
  const at = data.spheres.map((_, k) => centre(frame, k));
  data.spheres.forEach((_, i) => {
    const near = [];
    for (let k = 0; k < at.length; ++k) {
      const away = at[i].distanceTo(at[k]);
      if (k !== i && away > 0 && away < 4 * drawnRadius(k) + drawnRadius(i)) near.push([-drawnRadius(k) / away, k]);
    }
    near.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const { count, others } = spheres[i].material.uniforms;
    count.value = Math.min(near.length, kMostOccluders);
    for (let n = 0; n < count.value; ++n) others.value[n].set(...at[near[n][1]].toArray(), drawnRadius(near[n][1]));
  });
}

function placeShadow(mesh, at, radius, fromAbove) {
  mesh.visible = fromAbove && finite(at) && at.z > low.z;
  if (!mesh.visible) return;
  mesh.position.set(at.x, at.y, low.z);
  mesh.scale.set(1.6 * radius, 1.6 * radius, 1);
}

function place(frame) {
  const { near } = axes(), unit = pixel();
  const fromAbove = near.z > 0;
  const seen = [];  // depths
  for (let c = 0; c < 8; ++c)
    seen.push(near.dot(new THREE.Vector3(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z)));
  spheres.forEach((mesh, k) => {
    const at = centre(frame, k), radius = Math.max(drawnRadius(k), 1e-9);
    mesh.visible = rims[k].visible = finite(at);
    mesh.scale.setScalar(radius);
    placeShadow(shadows[k], at, radius, fromAbove);
    if (!mesh.visible) return;
    seen.push(near.dot(at));
    mesh.position.copy(at);
    rims[k].position.copy(at).addScaledVector(near, -0.35 * radius);
    rims[k].quaternion.copy(camera.quaternion);
    rims[k].scale.setScalar(radius + unit);
  });
  const far = near.dot(camera.position);
  depths.value.set(Math.max(...seen) - far, Math.min(...seen) - far);
  if (spheres.length <= 4096) placeOccluders(frame);
  placeSticks(frame);
  const at = number3(frame.hip);
  for (const mesh of hip) {
    mesh.visible = finite(at);
    if (mesh.visible) mesh.position.copy(at);
  }
  placeShadow(shadows[spheres.length], at, data.hip_radius, fromAbove);
  floor.visible = fromAbove;
  placeArrow(frame);
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

function fit() {
  view = { azimuth: data.azimuth, elevation: data.elevation, centre: number3(data.centre), zoom: 1 };
}

/// From the middle to the nearer edges, in the model's unit.
function halfWidth() {
  const [width, height] = [element("scene").clientWidth, element("scene").clientHeight];
  const shorter = Math.min(width, height);
  const beside = hasForceBar() ? 80 : 0;  // pixels, half of them for the bar
  return Math.max(data.extent[0] * shorter / Math.max(width - beside, 40), data.extent[1] * shorter / height) / view.zoom;
}

/// The size of a pixel in the model's unit.
function pixel() {
  return 2 * halfWidth() / Math.min(element("scene").clientWidth, element("scene").clientHeight);
}

function aim() {
  const [width, height] = [element("scene").clientWidth, element("scene").clientHeight];
  const { up, near } = axes();
  const unit = pixel();
  const far = 4 * (halfWidth() + high.distanceTo(low)) + view.centre.distanceTo(low);
  camera.left = -(camera.right = unit * width / 2);
  camera.bottom = -(camera.top = unit * height / 2);
  camera.near = 0;
  camera.far = 2 * far;
  camera.up.copy(up);
  camera.position.copy(view.centre).addScaledVector(near, far);
  camera.lookAt(view.centre);
  camera.updateProjectionMatrix();
  if (renderer) renderer.setSize(width, height);
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

/// The longest of the lengths that the legend can have, with its text, or the shortest.
function legendLength(most) {
  return data.lengths.reduce((best, next) => (next[0] <= most ? next : best));
}

/// From a place of the picture; those that point at the viewer are left out.
function drawAxes(c, x, y, length) {
  const { right, up } = axes();
  for (const axis of ["x", "y", "z"]) {
    const shown = Math.hypot(right[axis], up[axis]);
    if (shown < 0.3) continue;
    const along = right[axis] / shown, down = -up[axis] / shown, end = length * shown;
    c.moveTo(x, y);
    c.lineTo(x + end * along, y + end * down);
    c.textAlign = "center";
    c.fillText(axis, x + (end + 9) * along, y + (end + 9) * down);
    c.textAlign = "left";
  }
}

function drawLegend(width, height, unit) {  // as libcore/scene/legend.cpp does
  const c = context(element("legend"), width, height);
  const [length, says] = legendLength(0.25 * width * unit);
  const bar = length / unit, left = 10, bottom = height - 10;
  c.strokeStyle = c.fillStyle = "#292b33";
  c.lineWidth = 1.2;
  c.beginPath();
  c.moveTo(left, bottom - 3); c.lineTo(left, bottom + 3);
  c.moveTo(left, bottom); c.lineTo(left + bar, bottom);
  c.moveTo(left + bar, bottom - 3); c.lineTo(left + bar, bottom + 3);
  c.fillText(says, left + bar + 5, bottom);
  const longest = Math.min(45, 0.12 * Math.min(width, height));
  drawAxes(c, left + longest + 16, bottom - longest - 30, longest);
  c.stroke();
  if (frames.length === 0) return;
  nameTurned(c, width, height, unit);
  drawHand(c, width, height, unit);
  drawFlash(c, width, height, unit);
  if (hasForceBar()) drawForceBar(c, width, height);
}

/// Where a place of the model's space is in the picture.
function onScreen(v, width, height, unit) {
  const { right, up } = axes();
  const at = v.clone().sub(view.centre);
  return [width / 2 + right.dot(at) / unit, height / 2 - up.dot(at) / unit];
}

function turnedText(k) {
  const degrees = frames[shown].turned[k];
  return `${data.torsions[k][0]} ${degrees < 0 ? "" : "+"}${degrees.toFixed(0)}°`;
}

/// The torsions that have turned since the beginning.
function whatTurned() {
  return data.torsions.map((_, k) => k).filter((k) => Math.abs(frames[shown].turned[k]) >= data.least_turn);
}

function nameTurned(c, width, height, unit) {  // each at the middle of its bond
  c.textAlign = "center";
  const plates = [];
  for (const k of whatTurned()) {
    const [, a, b] = data.torsions[k];
    const middle = centre(frames[shown], a).add(centre(frames[shown], b)).multiplyScalar(0.5);
    const wide = c.measureText(turnedText(k)).width + 8;
    const [x, ...rest] = onScreen(middle, width, height, unit);
    let [y] = rest;
    while (plates.some(([px, py, pw]) => Math.abs(x - px) < (wide + pw) / 2 && Math.abs(y - py) < 16)) y += 16;
    plates.push([x, y, wide]);
    c.fillStyle = "#fff";
    c.fillRect(x - wide / 2, y - 8, wide, 16);
    c.fillStyle = "#292b33";
    c.fillText(turnedText(k), x, y);
  }
  c.textAlign = "left";
}

/// A ring where the hand is, and a thread from there to the HIP: the longer, the more the model resists.
function drawHand(c, width, height, unit) {
  const at = hand && following() ? hand : number3(frames[shown].hand);
  if (!finite(at)) return;
  const [x, y] = onScreen(at, width, height, unit);
  const [hx, hy] = onScreen(number3(frames[shown].hip), width, height, unit);
  c.strokeStyle = data.hand_colour;
  c.lineWidth = 2;
  c.beginPath();
  const away = Math.hypot(hx - x, hy - y);
  if (away > 9) {
    c.moveTo(x + 9 * (hx - x) / away, y + 9 * (hy - y) / away);
    c.lineTo(hx, hy);
  }
  c.moveTo(x + 9, y);
  c.arc(x, y, 9, 0, 2 * Math.PI);
  c.stroke();
}

/// Rings around the HIP for a moment after the model snapped.
function drawFlash(c, width, height, unit) {
  const frame = frames[shown];
  let i = shown;
  while (i > 0 && !frames[i].snapped && frames[i].time > frame.time - kFlashSeconds) --i;
  if (!frames[i].snapped || frames[i].time < frame.time - kFlashSeconds) return;
  const [x, y] = onScreen(number3(frame.hip), width, height, unit);
  c.strokeStyle = data.snap_colour;
  c.lineWidth = 2;
  for (const wider of [4, 10]) {
    c.beginPath();
    c.arc(x, y, data.hip_radius / unit + wider, 0, 2 * Math.PI);
    c.stroke();
  }
}

const hasForceBar = () => live && data.full_force > 0;

function drawForceBar(c, width, height) {
  const x = width - 26, top = 0.4 * height, bottom = height - 26;
  if (Math.min(width, height) < 150) return;
  c.fillStyle = "#dee0e6";
  c.fillRect(x - 7, top, 14, bottom - top);
  c.fillStyle = data.force_colour;
  const part = clamp(frames[shown].size / data.full_force, 0, 1);
  c.fillRect(x - 7, bottom - part * (bottom - top), 14, part * (bottom - top));
  c.fillStyle = "#292b33";
  c.textAlign = "right";
  c.fillText(`${round(data.full_force)} N`, width - 8, top - 10);
  c.textAlign = "left";
}

// --- Force and energy ---------------------------------------------------------------------------------------

const round = (x) => (Number.isFinite(x) ? parseFloat(x.toPrecision(3)) : "");

/// The frames of the curves: all of a file, the last seconds of a live page; and the times at both ends.
function curveFrames() {
  if (!live) return [frames, frames[0].time, frames[frames.length - 1].time];
  const end = frames[frames.length - 1].time;
  return [frames.filter((frame) => frame.time >= end - kCurveSeconds), end - kCurveSeconds, end];
}

function drawCurve(c, place, list, at, values, name, colours) {
  const { left, right, top, bottom } = place;
  const real = values.flatMap((value) => list.map(value)).filter(Number.isFinite);
  const least = place.fromZero ? 0 : real.reduce((a, b) => Math.min(a, b), Infinity);
  let most = real.reduce((a, b) => Math.max(a, b), least);
  if (!(most > least)) most = least + (Math.abs(least) / 1000 || 1);
  const y = (v) => bottom - 1 - (bottom - top - 2) * (v - least) / (most - least);
  c.fillStyle = "#fff";
  c.fillRect(left, top, right - left, bottom - top);
  c.fillStyle = data.snap_colour;
  for (const frame of list) if (frame.snapped) c.fillRect(at(frame.time) - 1, top, 2, bottom - top);
  c.fillStyle = colours[0];
  // On two lines where it is long: the quantity, and its unit.
  const [quantity, ...unit] = name.split(" / ");
  const lines = name.length > 10 ? [quantity, "/ " + unit.join(" / ")] : [name];
  lines.forEach((line, n) => c.fillText(line, 0, (top + bottom) / 2 + 13 * (n - (lines.length - 1) / 2), left - 4));
  c.fillStyle = "#282c34";
  c.textAlign = "right";
  c.fillText(round(most), left - 4, top + 5);
  c.fillText(round(least), left - 4, bottom - 5);
  c.textAlign = "left";
  c.lineWidth = 1.5;
  c.lineJoin = "round";
  values.forEach((value, n) => {
    c.strokeStyle = colours[n];
    c.beginPath();
    let drawn = false;  // a point that the next one is joined with
    for (const frame of list) {
      const v = value(frame);
      if (Number.isFinite(v)) drawn ? c.lineTo(at(frame.time), y(v)) : c.moveTo(at(frame.time), y(v));
      drawn = Number.isFinite(v);
    }
    c.stroke();
  });
  if (values.length > 1 && list.some((frame) => Number.isFinite(frame.own))) {
    c.fillStyle = colours[1];
    c.fillText("of the model alone", left + 4, top + 6);
  }
  c.fillStyle = "#282c34";
  c.fillRect(at(frames[shown].time) - 0.5, top, 1, bottom - top);
}

function drawCurves() {
  const width = element("below").clientWidth - 16, height = 134, left = 64, bottomRow = 14;
  const c = context(element("curves"), width, height);
  const [list, from, to] = curveFrames();
  const at = (t) => left + (width - left - 1) * (t - from) / (to - from || 1);
  const curves = [[[(frame) => frame.size], "force / N", [data.force_colour]]];
  if (list.some((frame) => Number.isFinite(frame.energy)))
    curves.push([[(frame) => frame.energy, (frame) => frame.own], data.energy_label,
                 [data.energy_colour, data.own_colour]]);
  const each = (height - bottomRow) / curves.length;
  curves.forEach(([values, name, colours], k) =>
    drawCurve(c, { left, right: width, top: k * each + 4, bottom: (k + 1) * each - 4, fromZero: k === 0 },
              list, at, values, name, colours));
  const row = height - bottomRow / 2;
  c.fillText(Math.max(from, 0).toFixed(2), left, row);
  c.textAlign = "center";
  c.fillText("t / s", (left + width) / 2, row);
  c.textAlign = "right";
  c.fillText(to.toFixed(2), width, row);
}

function drawStatus() {
  const frame = frames[shown];
  let text = `t ${frame.time.toFixed(2)} s   force ${round(frame.size)} N`;
  if (live) text += `   snaps ${snaps}`;
  else text += `   snaps ${frames.filter((f, i) => f.snapped && i <= shown).length} of ${frames.filter((f) => f.snapped).length}`;
  if (Number.isFinite(frame.energy)) text += `   energy ${round(frame.energy)} ${data.energy_unit}`;
  if (Number.isFinite(frame.own)) text += `   model alone ${round(frame.own)}`;
  text += whatTurned().map((k) => "   " + turnedText(k)).join("");
  if (ended) text += "   ended";
  element("status").textContent = text;
}

// --- What the reader does -----------------------------------------------------------------------------------

function say(text, plate) {
  element("say").textContent = text;
  element("say").className = plate ? "plate" : "";
}

function draw() {
  aim();
  if (frames.length === 0) return;
  place(frames[shown]);
  if (renderer) renderer.render(scene, camera);
  element("time").max = frames.length - 1;
  element("time").value = shown;
  drawCurves();
  drawStatus();
}

let due = false;

/// Draws before the screen's next picture, once however often it is asked.
function drawSoon() {
  if (due) return;
  due = true;
  requestAnimationFrame(() => {
    due = false;
    draw();
  });
}

/// Whether a live page shows the newest frame.
function following() {
  return live && playing !== null;
}

/// The frame nearest to a time, the earlier of two.
function nearest(t) {
  let from = 0, to = frames.length - 1;
  while (from < to) {
    const middle = (from + to) >> 1;
    if (frames[middle + 1].time - t < t - frames[middle].time) from = middle + 1;
    else to = middle;
  }
  return from;
}

function setPlaying(yes) {
  if (live && yes) shown = frames.length - 1;
  else if (yes && shown === frames.length - 1) shown = 0;
  playing = yes ? { since: performance.now(), from: frames.length ? frames[shown].time : 0 } : null;
  element("play").textContent = yes ? "pause" : "play";
  if (yes && !live) requestAnimationFrame(step);
  drawSoon();
}

function step(now) {
  if (!playing) return;
  shown = nearest(playing.from + (now - playing.since) / 1000);
  draw();
  if (shown === frames.length - 1) setPlaying(false);
  else requestAnimationFrame(step);
}

/// Moves the hand by so many pixels to the right and down, and by a length towards the viewer.
function moveHand(right, down, nearer) {
  if (!hand || !socket || socket.readyState !== WebSocket.OPEN) return;
  const of = axes(), unit = pixel();
  hand.addScaledVector(of.right, unit * right).addScaledVector(of.up, -unit * down).addScaledVector(of.near, nearer);
  hand.max(number3(data.hand_low)).min(number3(data.hand_high));
  socket.send(`${hand.x} ${hand.y} ${hand.z}\n`);
  drawSoon();
}

const depthStep = () => low.clone().sub(high).toArray().reduce((a, b) => Math.max(a, Math.abs(b)), 0) / 40;

function turnView(right, down) {
  view.azimuth -= 0.4 * right;
  view.elevation = clamp(view.elevation + 0.4 * down, -90, 90);
  drawSoon();
}

function moveView(right, down) {
  const of = axes(), unit = pixel();
  view.centre.addScaledVector(of.up, unit * down).addScaledVector(of.right, -unit * right);
  drawSoon();
}

function zoomView(by) {
  view.zoom = clamp(view.zoom * by, 0.01, 1000);
  drawSoon();
}

const pointers = new Map();  // those that are down, with where they were

/// Two fingers: their distance zooms; together they turn the picture where one finger is the hand, and move it elsewhere.
function moveTwo(e) {
  const other = [...pointers].find(([id]) => id !== e.pointerId)[1];
  const was = pointers.get(e.pointerId);
  const span = ([x, y]) => Math.max(1, Math.hypot(x - other[0], y - other[1]));
  zoomView(span([e.clientX, e.clientY]) / span(was));
  const way = [(e.clientX - was[0]) / 2, (e.clientY - was[1]) / 2];
  if (hand && !turning) turnView(...way);
  else moveView(...way);
}

function onMove(e) {
  const was = pointers.get(e.pointerId);
  if (!was) return;
  const way = [e.clientX - was[0], e.clientY - was[1]];
  if (pointers.size === 2) moveTwo(e);
  else if (e.buttons === 1 && !e.shiftKey && hand && !turning) moveHand(...way, 0);
  else if (e.shiftKey || (e.buttons !== 1 && (!hand || turning))) moveView(...way);
  else turnView(...way);
  pointers.set(e.pointerId, [e.clientX, e.clientY]);
}

function showHelp() {
  const lines = hand
    ? ["drag, one finger: the hand. Wheel, near, far: nearer or away.", "right drag, two fingers: turn. Pinch, ctrl + wheel: zoom.",
       "shift + drag: move the picture. t: a drag turns it.",
       "The ring is the hand. The ball follows it; where the model resists, the thread grows, and where the model snaps, it shrinks."]
    : ["drag, one finger: turn. Right drag, two fingers: move. Wheel, pinch: zoom."];
  lines.push("space: stop, go on.   b: balls and sticks.   r: the first view.   s: save the picture.   h: this help.");
  if (data.keys) lines.push("In the terminal of play: " + data.keys);
  say(element("say").className ? "" : lines.join("\n"), !element("say").className);
}

function save() {
  draw();
  const picture = document.createElement("canvas");
  const legend = element("legend");
  [picture.width, picture.height] = [legend.width, legend.height];
  const c = picture.getContext("2d");
  if (renderer) c.drawImage(renderer.domElement, 0, 0, picture.width, picture.height);
  c.drawImage(legend, 0, 0);
  const link = document.createElement("a");
  link.download = `hapgrid-${frames.length ? frames[shown].time.toFixed(2) : 0}.png`;
  link.href = picture.toDataURL("image/png");
  link.click();
}

function setTurning(yes) {
  turning = yes;
  element("turn").className = yes ? "on" : "";
}

const actions = {
  play: () => setPlaying(!playing),
  turn: () => setTurning(!turning),
  sticks: () => { sticks = !sticks; drawSoon(); },
  fit: () => { fit(); drawSoon(); },
  save, help: showHelp,
};
const keys = { " ": "play", t: "turn", b: "sticks", r: "fit", s: "save", h: "help", "?": "help" };

/// A button that acts again while it is held.
function hold(id, act) {
  let timer = null;
  const stop = () => clearInterval(timer);
  element(id).addEventListener("pointerdown", () => { act(); stop(); timer = setInterval(act, 60); });
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) element(id).addEventListener(end, stop);
}

function listen() {
  const area = element("scene");
  area.addEventListener("pointerdown", (e) => {
    area.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, [e.clientX, e.clientY]);
    e.preventDefault();
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    area.addEventListener(end, (e) => pointers.delete(e.pointerId));
  area.addEventListener("contextmenu", (e) => e.preventDefault());
  area.addEventListener("pointermove", onMove);
  area.addEventListener("wheel", (e) => {
    if (hand && !turning && !e.ctrlKey) moveHand(0, 0, Math.sign(e.deltaY) * depthStep());
    else zoomView(Math.pow(1.1, -Math.sign(e.deltaY)));
    e.preventDefault();
  }, { passive: false });
  element("time").addEventListener("input", (e) => {
    setPlaying(false);
    shown = Number(e.target.value);
    drawSoon();
  });
  for (const id in actions) element(id).addEventListener("click", actions[id]);
  hold("nearer", () => moveHand(0, 0, depthStep()));
  hold("farther", () => moveHand(0, 0, -depthStep()));
  window.addEventListener("keydown", (e) => {
    if (!(e.key in keys) || e.ctrlKey || e.altKey || e.metaKey) return;
    actions[keys[e.key]]();
    e.preventDefault();
  });
  window.addEventListener("resize", drawSoon);
  window.addEventListener("hashchange", goToHash);
}

/// page.html#t=2.5 shows that time of play.
function goToHash() {
  const t = parseFloat(location.hash.replace("#t=", ""));
  if (Number.isFinite(t) && frames.length) shown = nearest(t);
  draw();
}

// --- The live page ------------------------------------------------------------------------------------------

/// A frame came: those that are too old go.
function take(frame) {
  frames.push(frame);
  if (frame.snapped) ++snaps;
  while (frames.length > 2 && (frames[0].time < frame.time - kLiveSeconds || frames.length * frame.bytes > kLiveBytes)) {
    frames.shift();
    shown = Math.max(0, shown - 1);
  }
  if (following()) shown = frames.length - 1;
  drawSoon();
}

function onText(message) {
  if (message.scene) {
    data = message.scene;
    build();
    fit();
    listen();
    setPlaying(true);
  } else if (message.hand) {
    hand = number3(message.hand);
    for (const id of ["nearer", "farther", "turn"]) element(id).hidden = false;
    say("Drag: the hand.   ?: help");
  } else if (message.ended) {
    ended = true;
    drawSoon();
  }
}

function connect() {
  live = true;
  say("waiting for frames");
  const address = new URL("ws", location.href);
  address.protocol = "ws:";
  address.hash = "";
  socket = new WebSocket(address, "hapgrid");
  socket.binaryType = "arraybuffer";
  socket.onmessage = (e) => {
    if (typeof e.data === "string") {
      onText(JSON.parse(e.data));
    } else {
      socket.send(".\n");  // so that view sends no more than arrives
      take(decode(e.data));
    }
  };
  socket.onclose = () => {
    hand = null;
    ended = true;
    if (!element("say").className) say(data ? "" : "view has no frames for this page any more");
    if (data) drawSoon();
  };
}

if (data) {
  for (const text of data.frames) frames.push(decode(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer));
  build();
  fit();
  listen();
  goToHash();
} else {
  connect();
}
