// The page that plays its grid by itself: `packed` holds the grid and the player (tools/page/player.cpp), and this makes
// of the player's numbers the frames that page_frame() in page.cpp makes for other pages.

const kTicksASecond = 1000;
const kLongestPause = 100;  // ticks that are made up for after the browser was busy
const kRestSeconds = 5;     // of a hand that does nothing: then time stops, and the battery lasts
const kPathTicks = 600000;  // that are kept to be saved
let player = null;          // what the player exports, and what this page knows of the play

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// As turned_text() in libcore/scene/scene.cpp.
const turnedText = (name, by) => `${name} ${by < 0 ? "−" : "+"}${Math.abs(by).toFixed(0)}°`;

/// What the player shows now, as a frame.
function playedFrame() {
  player.show();
  const { own } = data, { buffer } = player.memory;
  const shown = new Float64Array(buffer, player.shown_at(), 26), list = (from, size) => Array.from(shown.subarray(from, from + size));
  const time = shown[10] / kTicksASecond, force = list(3, 3);
  const energy = own.force_scale > 0 ? (own.lowest + shown[20]) / own.force_scale : NaN;
  const angles = new Float64Array(buffer, player.turned_at(), own.torsions.length);
  const turned = own.torsions.map(([a, b, name], k) => [a, b, turnedText(name, angles[k]), Math.abs(angles[k])]).filter((one) => one[3] >= own.turned);
  const farthest = turned.reduce((best, one) => (best && best[3] > one[3] ? best : one), null);
  const status = `t ${time.toFixed(2)} s   force ${threeDigits(Math.hypot(...force))} N` +
    (Number.isFinite(energy) ? `   energy ${threeDigits(energy)} ${own.energy_unit}` : "") + (farthest ? `   ${farthest[2]}` : "");
  const ends = new Uint32Array(buffer, player.bonds_at(), 2 * shown[25]);
  return {
    time, jumps: shown[9], hip: list(0, 3), force, hand: [...hand], energy, own: NaN, arrow: list(21, 4), status, turned,
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

/// Before each picture of the screen: the ticks that are due since the last one.
function playOn(now) {
  player.due = Math.min(kLongestPause, player.due + (now - (player.last ?? now)) * kTicksASecond / 1000);
  player.last = now;
  const ticks = Math.floor(player.due);
  if (ticks > 0 && following()) {
    playTicks(ticks, player.wants_next);
    player.wants_next = false;
    take(decode(playedFrame()));
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

/// One sentence for somebody who has this file and no other word.
const introduction = () =>
  `Drag with the mouse or a finger: the ring is your hand, the magenta ball hangs on it by a thread, and the model resists where you push the ` +
  `ball into it, until it yields or snaps (${data.own.grid}, played by hapgrid ${data.own.version}).`;

async function startPlayer() {
  live = true;
  say("loading");
  const [code, grid] = await Promise.all([packed.player, packed.grid].map(inflate));
  const { instance } = await WebAssembly.instantiate(code);
  player = { ...instance.exports, due: 1, last: null, idle: 0, wants_next: false, nexts: [], path: new Float64Array(3 * kPathTicks), kept: 0 };
  player._initialize();
  const room = player.room_for(grid.length);  // which can move the memory
  new Uint8Array(player.memory.buffer).set(grid, room);
  player.begin(...data.own.start);
  say("");
  build();
  takeHand(data.own.start);
  element("path").hidden = false;
  setPlaying(true);
  wake();
}
