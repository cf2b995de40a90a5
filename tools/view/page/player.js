// The page that plays its grid by itself: `packed` holds the grid and the player (tools/page/player.cpp), and this makes
// of the player's numbers the frames that page_frame() in page.cpp makes for other pages.

const kTicksASecond = 1000;
const kLongestPause = 100;  // ticks that are made up for after the browser was busy
const kRestSeconds = 5;     // of a hand that does nothing: then time stops, and the battery lasts
const kPathTicks = 600000;  // that are kept to be saved
const kOfTheHand = "With the hand: the model's energy, and what the hand stores by pulling or pushing. Both numbers are " +
  "interpolated between the grid's points, so that this one can be a little lower.";
let lettingGo = false;      // the hand goes where the force leads, until there is none
let player = null;          // what the player exports, and what this page knows of the play

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// What the player shows now, as a frame.
function playedFrame() {
  player.show();
  const { own } = data, { buffer } = player.memory;
  const shown = new Float64Array(buffer, player.shown_at(), 27), list = (from, size) => Array.from(shown.subarray(from, from + size));
  const time = shown[10] / kTicksASecond, force = list(3, 3);
  const energy = own.force_scale > 0 ? (own.lowest + shown[20]) / own.force_scale : NaN;
  const angles = Array.from(new Float64Array(buffer, player.angles_at(), own.torsions.length));
  const model = shown[26], hasOwn = Number.isFinite(energy + model);
  const status = `t ${time.toFixed(2)} s   force ${threeDigits(Math.hypot(...force))} N` +
    (Number.isFinite(energy) ? `   energy ${threeDigits(hasOwn ? model : energy)} ${own.energy_unit}` : "") +
    (hasOwn ? ` of the model alone, ${threeDigits(energy)} with the hand` : "");
  if (hasOwn) element("status").title = kOfTheHand;
  const ends = new Uint32Array(buffer, player.bonds_at(), 2 * shown[25]);
  return {
    time, jumps: shown[9], hip: list(0, 3), force, hand: [...hand], energy, own: model, arrow: list(21, 4), status, angles, turned: [],
    centres: new Float32Array(buffer, player.centres_at(), 3 * data.spheres.length),
    bonds: Array.from({ length: shown[25] }, (_, k) => [ends[2 * k], ends[2 * k + 1]]),
  };
}

/// So many ticks, of which the first can want the next level; the HIP's places are kept.
function playTicks(most, next) {
  const done = player.play(...hand, most, next), room = kPathTicks - player.kept;
  if (next) player.nexts.push(player.kept);
  const places = new Float64Array(player.memory.buffer, player.way_at(), 3 * Math.min(done, room));
  player.path.set(places, 3 * player.kept);
  player.kept += places.length / 3;
}

/// The hand a little along the force: at most a fiftieth of the box in each picture.
function followForce(frame, least = 0.005) {
  const step = Math.max(...plus(data.high, data.low, -1)) / 50, part = Math.min(1, 4 * frame.size / data.full_force);
  lettingGo = frame.size > least * data.full_force;
  if (!lettingGo) return;
  hand = plus(frame.hip, frame.force, step * part / frame.size).map((x, a) => clamp(x, data.low[a], data.high[a]));
  player.idle = 0;
}

/// Begins to play the packed grid.
function beginAt(grid) {
  hand = [...data.own.start];
  const room = player.room_for(grid.length);  // which can move the memory
  new Uint8Array(player.memory.buffer).set(grid, room);
  player.begin(...hand);
  player.kept = 0;
}

/// Begins where no force acts, which can be between the grid's points: an atom that is held has one such place.
function beginAtRest(grid) {
  beginAt(grid);
  for (let ticks = 0; ticks < kTicksASecond; ticks += kLongestPause) playTicks(kLongestPause, false);  // to the force's full size
  for (let steps = 0; steps < 400; ++steps) {
    followForce(decode(playedFrame()), 0.001);
    if (!lettingGo) break;
    playTicks(20, false);
  }
  lettingGo = false;
  data.own.start = [...hand];
  beginAt(grid);
}

let restored = null;
function sayAWhile(text) {
  if (element("say").className) return;
  clearTimeout(restored);
  say(text);
  restored = setTimeout(() => { if (!element("say").className) say(introduction()); }, 2500);
}

/// Before each picture of the screen: the ticks that are due since the last one.
function playOn(now) {
  player.due = Math.min(kLongestPause, player.due + (now - (player.last ?? now)) * kTicksASecond / 1000);
  player.last = now;
  const ticks = Math.floor(player.due);
  if (ticks > 0 && following()) {
    if (lettingGo) followForce(frames.at(-1));
    playTicks(ticks, player.wants_next);
    take(decode(playedFrame()));
    sayBarriers(frames.at(-1));
    if (player.wants_next && !frames.at(-1).snapped) sayAWhile("The grid has no other state at this place.");
    player.wants_next = false;
  }
  player.due -= ticks;
  player.idle += ticks;
  if (player.idle < kRestSeconds * kTicksASecond) requestAnimationFrame(playOn);
  else player.last = null;
}

/// The hand moved, or wants something: time goes on.
function wake() {
  const rests = player.last === null;
  player.idle = 0;
  if (!rests) return;
  player.last = undefined;
  requestAnimationFrame(playOn);
}

/// The HIP's places so far, for play --device path:FILE. To the bit it is what was played here: JavaScript writes a
/// number so that it is read as the same one.
function savePath() {
  const lines = [`# the path of a hand in ${data.own.grid}, by hapgrid ${data.own.version}; the same forces again:`,
    `# hapgrid play ${data.own.grid} --beside off --device path:FILE`];
  const nexts = new Set(player.nexts), text = (x) => (Object.is(x, -0) ? "-0" : String(x));
  for (let i = 0; i < player.kept; ++i)
    lines.push(Array.from(player.path.subarray(3 * i, 3 * i + 3), text).join(" ") + (nexts.has(i) ? " next" : ""));
  download("hapgrid-path.txt", URL.createObjectURL(new Blob([lines.join("\n") + "\n"], { type: "text/plain" })));
}

/// red, green, blue in [0, 1]
function colourName(rgb) {
  const high = Math.max(...rgb), low = Math.min(...rgb), [r, g, b] = rgb;
  if (high - low < 0.15) return high > 0.75 ? "white" : high < 0.25 ? "black" : "grey";
  const hue = 60 * (high === r ? (g - b) / (high - low) : high === g ? 2 + (b - r) / (high - low) : 4 + (r - g) / (high - low));
  return ["red", "orange", "yellow", "green", "blue", "purple"][[15, 45, 72, 165, 260, 320].findIndex((end) => hue >= -40 && hue < end)] ?? "red";
}

let held = -1;  // the sphere that the hand holds at the start, if any
function findHeld(frame) {
  const near = (one, k) => distance(sphere(frame, k), data.own.start) < 0.2 * (one[0] + data.hip_radius);
  held = frame.bonds.length === 0 ? -1 : data.spheres.findIndex(near);
}

/// Where the hand leads an atom around one bond, the first view is along this bond: the atom goes round in the picture.
function lookAlongBond() {
  const [bond] = data.own.torsions;
  if (held < 0 || data.own.torsions.length !== 1) return;
  const [far, near] = bond.slice(0, 2).map((k) => sphere(frames[0], k)).sort((a, b) => distance(b, data.own.start) - distance(a, data.own.start));
  const unit = (v) => v.map((x) => x / (Math.hypot(...v) || 1)), along = unit(plus(near, far, -1));
  const up = unit(plus([0, 0, 1], along, -along[2])), side = [0, 1, 2].map((a) => up[(a + 1) % 3] * along[(a + 2) % 3] - up[(a + 2) % 3] * along[(a + 1) % 3]);
  if (!(Math.hypot(...side) > 0.99)) return;  // upright
  const axes = [side, up, along], ends = axes.map(() => [Infinity, -Infinity]);
  const see = (at, radius) => axes.forEach((axis, a) => {
    ends[a] = [Math.min(ends[a][0], dot(axis, at) - radius), Math.max(ends[a][1], dot(axis, at) + radius)];
  });
  data.spheres.forEach(([radius], k) => see(sphere(frames[0], k), radius));
  const spheres = ends[0][1];
  for (let c = 0; c < 8; ++c) see(boxCorner(c), data.hip_radius);
  const middle = ends.map(([low, high]) => (low + high) / 2);
  data.axes = axes;
  data.centre = axes.reduce((sum, axis, a) => plus(sum, axis, middle[a]), [0, 0, 0]);
  data.extent = [ends[0][1] - middle[0], ends[1][1] - middle[1], spheres - middle[0]].map((x) => 1.06 * Math.max(0, x));
}

/// What somebody who has this file and no other word should do, from what is in the scene.
function goal() {
  const { own, spheres } = data, largest = spheres.map((one, k) => [one[0], k]).sort((a, b) => b[0] - a[0]);
  const end = own.snaps ? "it snaps" : "it yields";
  if (held >= 0) {
    const name = data.names[held] || "an atom";
    return own.torsions.length ? `Drag the pink ring: it holds ${name}. Lead ${name} round the bond, over a hump of the curve, then press "let go".`
      : `Drag the pink ring: it holds ${name}. Lead it on until ${end}, then press "let go".`;
  }
  if (own.torsions.length) return `Drag the pink ball against the molecule until a bond ${own.snaps ? "turns over" : "yields"}.`;
  if (largest.length > 1 && largest[0][0] > 1.5 * largest[1][0])
    return `Drag the pink ball against the ${colourName(spheres[largest[0][1]].slice(1))} one until ${end}.`;
  return own.snaps ? "Drag the pink ball into the model until it snaps." : "Drag the pink ball: the arrow is the force that a hand feels there.";
}

const introduction = () => `${goal()} The ring is your hand, and the thread grows with the force. (${data.own.grid}, hapgrid ${data.own.version})`;

async function startPlayer() {
  live = true;
  say("loading");
  const [code, grid] = await Promise.all([packed.player, packed.grid].map(inflate));
  const { instance } = await WebAssembly.instantiate(code);
  player = { ...instance.exports, due: 1, last: null, idle: 0, wants_next: false, nexts: [], path: new Float64Array(3 * kPathTicks), kept: 0 };
  player._initialize();
  beginAtRest(grid);
  say("");
  build();
  playTicks(1, false);
  take(decode(playedFrame()));
  findHeld(frames[0]);
  lookAlongBond();
  fit();
  takeHand(hand);
  element("path").hidden = false;
  setPlaying(true);
  wake();
}
