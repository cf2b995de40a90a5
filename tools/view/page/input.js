// What mouse, fingers, keys and buttons do.

let turning = false;         // a drag turns the picture although there is a hand
const pointers = new Map();  // those that are down, with where they were

/// Moves the hand by so many pixels to the right and down, and by a length towards the viewer.
function moveHand(right, down, nearer) {
  if (!hand) return;
  const [side, up, near] = view.axes, unit = pixel();
  const at = plus(plus(plus(hand, side, unit * right), up, -unit * down), near, nearer);
  hand = at.map((x, a) => clamp(x, data.hand_low[a], data.hand_high[a]));
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
    ? ["drag, one finger: the hand. Wheel, near, far: nearer or away.", "right drag, two fingers: turn. Pinch, ctrl + wheel: zoom.",
       "shift + drag: move the picture. t: a drag turns it.",
       "The ring is the hand. The ball follows it; where the model resists, the thread grows, and where the model snaps, it shrinks."]
    : ["drag, one finger: turn. Right drag, two fingers: move. Wheel, pinch: zoom."];
  if (hand) lines.push("n: the next level of the grid at this place.");
  lines.push("space: stop, go on.   b: balls and sticks.   r: the first view.   s: save the picture.   h: this help.");
  if (data.keys) lines.push("In the terminal of play: " + data.keys);
  say(element("say").className ? "" : lines.join("\n"), !element("say").className);
}

function download(name, address) {
  const link = document.createElement("a");
  link.download = name;
  link.href = address;
  link.click();
}

function save() {
  drawn = null;  // WebGL keeps a picture no longer than until the page is shown
  draw();
  const picture = document.createElement("canvas");
  const legend = element("legend");
  [picture.width, picture.height] = [legend.width, legend.height];
  const c = picture.getContext("2d");
  if (gl) c.drawImage(gl.canvas, 0, 0, picture.width, picture.height);
  c.drawImage(legend, 0, 0);
  download(`hapgrid-${frames.length ? frames[shown].time.toFixed(2) : 0}.png`, picture.toDataURL("image/png"));
}

const actions = {
  play: () => setPlaying(!playing),
  turn: () => { turning = !turning; element("turn").className = turning ? "on" : ""; },
  next: nextLevel,
  sticks: () => { sticks = !sticks; drawSoon(); },
  fit: () => { fit(); drawSoon(); },
  save, path: () => player && savePath(), help: showHelp,
};
const keys = { " ": "play", t: "turn", n: "next", b: "sticks", r: "fit", s: "save", h: "help", "?": "help" };

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
