// What mouse, fingers, keys and buttons do.

let turning = false;         // a drag turns the picture although there is a hand
const pointers = new Map();  // those that are down, with where they were
let pointed = null;          // where a pointer is that nobody has pressed, in pixels of the picture

/// Moves the hand by so many pixels to the right and down, and by a length towards the viewer.
function moveHand(right, down, nearer) {
  if (!hand) return;
  const [side, up, near] = view.axes, unit = pixel();
  const at = plus(plus(plus(hand, side, unit * right), up, -unit * down), near, nearer);
  hand = at.map((x, a) => clamp(x, data.hand_low[a], data.hand_high[a]));
  lettingGo = false;
  if (!following()) setPlaying(true);
  wake();
  drawSoon();
}

/// Another state at this place, if the grid has one: play goes there, and marks a snap.
function nextLevel() {
  if (!hand) return;
  player.wants_next = true;
  wake();
}

const depthStep = () => Math.max(...plus(data.high, data.low, -1)) / 40;

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
  pointed = pointers.size === 0 ? [e.offsetX, e.offsetY] : null;
  if (pointed && data?.names.some((name) => name)) drawSoon();
  const was = pointers.get(e.pointerId);
  if (!was) return;
  const way = [e.clientX - was[0], e.clientY - was[1]];
  if (pointers.size === 2) moveTwo(e);
  else if (e.buttons === 1 && !e.shiftKey && hand && !turning) moveHand(...way, 0);
  else if (e.shiftKey || (e.buttons !== 1 && (!hand || turning))) moveView(...way);
  else turnView(...way);
  pointers.set(e.pointerId, [e.clientX, e.clientY]);
}

function say(text, plate) {
  element("say").textContent = text;
  element("say").className = plate ? "plate" : "";
}

function showHelp() {
  const lines = hand
    ? ["drag, one finger, arrow keys: the hand. Wheel, near, far, page keys: nearer or away.", "right drag, two fingers: turn. Pinch, ctrl + wheel: zoom.",
       "shift + drag: move the picture. t: a drag turns it.",
       "The ring is the hand. The ball follows it; where the model resists, the thread grows, and where the model snaps, it shrinks. Where no force acts it is dashed."]
    : ["drag, one finger, arrow keys: turn. Right drag, two fingers: move. Wheel, pinch: zoom."];
  if (hand) lines.push("let go (l): the hand follows the force until there is none.   next (n): another state of the model at this place, if the grid has one.",
    "sound: a click at each snap.   The bar at the right is the force, up to the limit that is sent to a device.   path: saves where the ball went, so that play --device path: repeats it.");
  lines.push("pause, play (space): stop, go on.   sticks (b).   fit (r): the first view.   save (s): the picture.   ? (h): this help, and its end.");
  if (data.keys) lines.push("In the terminal of play: " + data.keys);
  if (element("say").className) say(player ? introduction() : "");
  else say(lines.join("\n"), true);
}

function download(name, address) {
  const link = document.createElement("a");
  link.download = name;
  link.href = address;
  link.click();
}

let sounds = true;  // at a snap
let audio = null;   // which a browser allows as soon as somebody has touched the page

/// What a snap is for ears and, on a phone, for the fingers.
function click() {
  if (!sounds) return;
  if (navigator.userActivation?.hasBeenActive && !calm()) navigator.vibrate?.(25);
  if (!audio) return;
  const tone = audio.createOscillator(), gain = audio.createGain(), now = audio.currentTime;
  tone.frequency.value = 900;
  gain.gain.setValueAtTime(0.2, now);
  gain.gain.exponentialRampToValueAtTime(0.001, now + 0.05);
  tone.connect(gain).connect(audio.destination);
  tone.start(now);
  tone.stop(now + 0.06);
}

/// The picture with all that is drawn over it.
function wholePicture() {
  sharpen();  // WebGL keeps a picture no longer than until the page is shown
  draw();
  const picture = document.createElement("canvas");
  const legend = element("legend");
  [picture.width, picture.height] = [legend.width, legend.height];
  const c = picture.getContext("2d");
  if (gl) c.drawImage(gl.canvas, 0, 0, picture.width, picture.height);
  c.drawImage(legend, 0, 0);
  return picture;
}

function save() {
  download(`hapgrid-${frames.length ? frames[shown].time.toFixed(2) : 0}.png`, wholePicture().toDataURL("image/png"));
}

/// A printer gets what WebGL has drawn as a picture of its own.
function print_(begins) {
  document.getElementById("printed")?.remove();
  if (!begins) return;
  const picture = wholePicture(), { width, height } = element("legend").style;
  picture.id = "printed";
  Object.assign(picture.style, { width, height });
  element("scene").append(picture);
}

const actions = {
  play: () => setPlaying(!playing),
  turn: () => { turning = !turning; element("turn").className = turning ? "on" : ""; },
  next: nextLevel,
  sticks: () => { sticks = !sticks; element("sticks").className = sticks ? "on" : ""; drawSoon(); },
  letgo: () => { if (hand) { lettingGo = true; wake(); } },
  fit: () => { fit(); drawSoon(); },
  sound: () => { sounds = !sounds; element("sound").className = sounds ? "on" : ""; element("sound").ariaPressed = sounds; },
  save, path: () => player && savePath(), help: showHelp,
};
/// As play --device keys has them; without a hand they turn the picture. Right, down, nearer.
const ways = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, -1, 0], ArrowDown: [0, 1, 0], PageUp: [0, 0, -1], PageDown: [0, 0, 1],
};

function onKey(e) {
  if (e.ctrlKey || e.altKey || e.metaKey) return;
  const on = e.target.tagName;
  if ((on === "BUTTON" && (e.key === " " || e.key === "Enter")) || (on === "INPUT" && e.key in ways)) return;
  if (e.key === "Escape" && element("say").className) showHelp();
  else if (e.key in ways) {
    const [right, down, nearer] = ways[e.key], step = depthStep() / 2;
    if (hand && !turning) moveHand(right * step / pixel(), down * step / pixel(), nearer * step);
    else if (nearer) zoomView(Math.pow(1.1, nearer));
    else turnView(20 * right, 20 * down);
  } else if (e.key in keys) actions[keys[e.key]]();
  else return;
  e.preventDefault();
}

const keys = { " ": "play", t: "turn", l: "letgo", n: "next", b: "sticks", r: "fit", s: "save", h: "help", "?": "help" };

/// A button that acts again while it is held.
function hold(id, act) {
  let timer = null;
  const stop = () => clearInterval(timer);
  element(id).addEventListener("pointerdown", () => { act(); stop(); timer = setInterval(act, 60); });
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) element(id).addEventListener(end, stop);
  element(id).addEventListener("click", (e) => { if (e.detail === 0) act(); });  // by a key
}

function listen() {
  const area = element("scene");
  area.addEventListener("pointerdown", (e) => {
    if (element("say").className && player) showHelp();  // ends it
    area.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, [e.clientX, e.clientY]);
    e.preventDefault();
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    area.addEventListener(end, (e) => pointers.delete(e.pointerId));
  area.addEventListener("pointerleave", () => { pointed = null; });
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
  window.addEventListener("keydown", onKey);
  for (const name of ["pointerdown", "keydown"])
    window.addEventListener(name, () => { if (hand) audio ??= new AudioContext(); }, { once: true });
  window.addEventListener("beforeprint", () => print_(true));
  window.addEventListener("afterprint", () => print_(false));
  window.addEventListener("resize", drawSoon);
  window.addEventListener("hashchange", goToHash);
}
