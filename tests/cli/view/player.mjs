// The player of a page of a grid, in node.
//
//   node player.mjs draw SEED PAGE > PATH     a hand: strokes through the box, slow and fast, with leaps of many cells, places
//                                             outside, rests, and now and then the next level
//   node player.mjs compare PAGE PATH LOG     the player on this path must give each number of the log that
//                                             `play --device path:PATH --beside off --log LOG` wrote
import { readFileSync } from "node:fs";
import { inflateSync } from "node:zlib";

const [what, ...args] = process.argv.slice(2);
const page = (file) => {
  const text = readFileSync(file, "utf8"), line = (name) => JSON.parse(text.match(new RegExp(`^${name} = (.*);$`, "m"))[1]);
  return { data: line("let data"), packed: line("const packed") };
};

function* random(seed) {  // xorshift32, in [0, 1)
  for (let x = seed | 1; ;) {
    x ^= x << 13; x ^= x >>> 17; x ^= x << 5;
    yield (x >>> 0) / 2 ** 32;
  }
}

function draw(seed, file) {
  const { data } = page(file), numbers = random(seed), next = () => numbers.next().value;
  const middle = data.low.map((x, a) => (x + data.high[a]) / 2), half = data.low.map((x, a) => (data.high[a] - x) / 2);
  const lines = [];
  for (let from = data.own.start; lines.length < 6000;) {
    const reach = [0.3, 0.5, 0.5, 0.8, 1.2][Math.floor(5 * next())], steps = [1, 3, 30, 100, 300][Math.floor(5 * next())];
    const to = middle.map((x, a) => x + reach * half[a] * (2 * next() - 1));
    for (let i = 1; i <= steps; ++i)
      lines.push(from.map((x, a) => x + (to[a] - x) * i / steps).join(" ") + (next() < 0.003 ? " next" : ""));
    from = to;
  }
  console.log(lines.join("\n"));
}

function compare(file, pathFile, logFile) {
  const { data, packed } = page(file), [code, grid] = [packed.player, packed.grid].map((text) => inflateSync(Buffer.from(text, "base64")));
  const module = new WebAssembly.Module(code);
  if (WebAssembly.Module.imports(module).length) throw new Error("the player imports something");
  const began = performance.now(), { exports: player } = new WebAssembly.Instance(module, {});
  player._initialize();
  const room = player.room_for(grid.length);
  new Uint8Array(player.memory.buffer).set(grid, room);
  player.begin(...data.own.start);
  const start = performance.now() - began;
  const path = readFileSync(pathFile, "utf8").trim().split("\n").filter((line) => line[0] !== "#").map((line) => line.split(" "));
  const log = readFileSync(logFile, "utf8").trim().split("\n").map((line) => line.split("\t")), names = log.shift();
  const column = (name) => names.indexOf(name);
  const columns = [column("sent_x"), column("sent_x") + 1, column("sent_x") + 2, column("force_x"), column("force_x") + 1, column("force_x") + 2];
  const levels = column("l0"), snap = column("snap"), shown = new Float64Array(player.memory.buffer, player.shown_at(), 20);
  if (path.length !== log.length) throw new Error(`${path.length} places and ${log.length} ticks`);
  let snaps = 0, largest = 0;
  path.forEach(([x, y, z, next], i) => {
    player.put(x, y, z, next === "next");
    const got = [...shown.subarray(3, 9), shown[11], ...shown.subarray(12, 20)];
    const wanted = [...columns, snap, ...Array.from({ length: 8 }, (_, k) => levels + k)].map((k) => Number(log[i][k]));
    got.forEach((number, k) => {
      if (number !== wanted[k] && !(Number.isNaN(number) && Number.isNaN(wanted[k])))
        throw new Error(`${file}: tick ${i}: the player has ${got}, and play ${wanted}`);
    });
    snaps += shown[11];
    largest = Math.max(largest, Math.hypot(...shown.subarray(6, 9)));
  });
  // What pictures show must be finite, and change with the state.
  player.show();
  const centres = new Float32Array(player.memory.buffer, player.centres_at(), 3 * data.spheres.length);
  if (!centres.every(Number.isFinite)) throw new Error("a sphere is nowhere");
  const before = process.cpuUsage();
  for (const [x, y, z] of path) player.put(x, y, z, false);
  const tick = process.cpuUsage(before).user / path.length;
  console.log(`${snaps} snaps, ${largest.toPrecision(3)} N; begins in ${start.toFixed(0)} ms, ${tick.toFixed(2)} us a tick, ` +
    `${(player.memory.buffer.byteLength / 1e6).toFixed(1)} MB`);
}

if (what === "draw") draw(Number(args[0]), args[1]);
else compare(...args);
