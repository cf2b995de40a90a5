// The page of view: `data` is the scene, and what it and a frame hold is in tools/view/page/page.cpp. In the file of
// view --html the frames are in it; the live page of view --web gets both by a WebSocket; the page of a grid makes the frames
// itself (player.js).
//
// view decides what is seen: texts, colours, sizes, the arrow, bonds, sticks, the first camera, and all numbers of the
// legend and of the light are data. The page turns the camera's axes itself, since a turn by the mouse must be seen at
// once and a saved page has no view beside it. From that follows what else it does: it multiplies places by these axes,
// takes the longest bar that fits the zoom, fits the model into its window, places the names of torsions, and finds the
// neighbours that darken each ball of the frame that is shown.

const frames = [];       // of a live page those of the last seconds
const kLiveSeconds = 20;
const kRetryMilliseconds = 1000;
const kMostNumbers = 16e6;  // of centres
let live = false;
let socket = null;
let ended = false;
let built = false;
let hand = null;         // where this page's hand is
let snaps = 0;           // of a live page, since it was opened
let largestForce = 0;    // alike, in newtons
let shown = 0;           // the frame
let playing = null;      // of a file: since when, and from which time of play on; of a live page: whether it goes on

/// A frame as page_frame() in page.cpp makes it, and what the drawing needs besides.
function decode(frame) {
  const before = frames[frames.length - 1];
  return {
    ...frame, centres: Float32Array.from(frame.centres, (x) => x ?? NaN), size: Math.hypot(...frame.force),
    snapped: before !== undefined && before.jumps !== frame.jumps,
  };
}

function build() {
  document.title = (data.own?.grid ?? data.model) + " - hapgrid";
  sticks = data.sticks || data.own?.torsions.length > 0;  // between which a bond is seen to turn
  element("sticks").className = sticks ? "on" : "";
  element("sticks").hidden = !data.names.some((name) => name);
  fit();
  if (built) return;  // a connection that was lost is there again
  built = true;
  buildPicture();
  listen();
}

function draw() {
  if (frames.length > 0) {
    if (gl) drawPicture(frames[shown]);
    element("time").max = frames.length - 1;
    element("time").value = shown;
    if (curvesAreDue()) drawCurves();
    drawStatus();
  }
  drawLegend();
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
  const away = (k) => Math.abs(frames[k].time - t);
  return frames.reduce((best, _, k) => (away(k) < away(best) ? k : best), 0);
}

function setPlaying(yes) {
  if (live && yes) shown = frames.length - 1;
  else if (yes && shown === frames.length - 1) shown = 0;
  playing = yes ? { since: performance.now(), from: frames.length ? frames[shown].time : 0 } : null;
  element("play").textContent = yes ? "pause" : "play";
  element("play").ariaPressed = yes;
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

/// page.html#t=2.5 shows that time of play.
function goToHash() {
  const t = parseFloat(location.hash.replace("#t=", ""));
  if (Number.isFinite(t) && frames.length) shown = nearest(t);
  draw();
}

/// A frame came: those that are too old go.
function take(frame) {
  frames.push(frame);
  largestForce = Math.max(largestForce, frame.size);
  if (frame.snapped) {
    ++snaps;
    element("news").textContent = `snap ${snaps}`;
    if (hand) click();
  }
  while (frames.length > 2 && (frames[0].time < frame.time - kLiveSeconds || frames.length * frame.centres.length > kMostNumbers)) {
    frames.shift();
    shown = Math.max(0, shown - 1);
  }
  if (following()) shown = frames.length - 1;
  drawSoon();
}

/// This page is the hand.
function takeHand(at) {
  hand = at;
  for (const id of ["nearer", "farther", "letgo", "turn", "next", "sound"]) element(id).hidden = false;
  if (gl) say(introduction());
}

function onMessage(message) {
  if (message.frame) {
    socket.send(".\n");  // so that view sends no more than arrives
    take(decode(message.frame));
  } else if (message.scene) {
    data = message.scene;
    build();
    if (gl) say("This page watches: it cannot move the hand.");
    lose(false);
    setPlaying(true);
  } else if (message.ended) {
    ended = true;
    drawSoon();
  }
}

/// What is shown is old, and says so.
function lose(yes) {
  element("scene").className = yes ? "lost" : "";
  if (yes) say("The connection is lost, and tried again each second. Is view still running, and the tunnel to it?", true);
}

function connect() {
  live = true;
  if (!data) say("waiting for frames");
  const address = new URL("ws", location.href);
  address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  address.hash = "";
  socket = new WebSocket(address, "hapgrid");
  socket.onmessage = (e) => onMessage(JSON.parse(e.data));
  socket.onclose = () => {
    if (ended) return;
    lose(true);
    setTimeout(connect, kRetryMilliseconds);
  };
}

if (packed) {
  startPlayer().catch((e) => say(`This browser cannot play the grid: ${e.message ?? e}`, true));
} else if (data) {
  for (const frame of recorded) frames.push(decode(frame));
  build();
  goToHash();
} else {
  connect();
}
