// The torsions of a page that plays its grid: of each a strip with its angle, the lowest energy of the model itself that
// the grid has at each angle, where on it the model is, and how high the next barrier is. The strip's number stands at the
// bond.

const kStrip = { width: 190, height: 64 };

/// From an angle on, to one side (-1, 1): the highest energy (sign 1) or the lowest (-1) before it goes back by a tenth of the
/// profile's span; to the highest the way can first lead down. [energy, bin]
function extreme(profile, angle, way, sign) {
  const known = profile.filter((v) => v !== null), least = 0.1 * (Math.max(...known) - Math.min(...known)), n = profile.length;
  const here = Math.round((angle + 180) / 360 * n) % n;
  let [top, at] = [-Infinity, 0];  // times the sign
  for (let i = 0; i < n; ++i) {
    const v = profile.at((here + way * i) % n);
    if (v === null) continue;
    if (sign * v > top) [top, at] = [sign * v, i];
    else if ((at > 0 || sign < 0) && top - sign * v > least) break;
  }
  return [sign * top, (here + way * at + n) % n];
}

/// How high the barriers on both sides of an angle are.
const barriersBeside = (profile, angle) => [-1, 1].map((way) => extreme(profile, angle, way, 1)[0]);

/// The lowest energy of the valley that an angle is in, and its bin.
function valleyOf(profile, angle) {
  const [left, right] = [-1, 1].map((way) => extreme(profile, angle, way, -1));
  return left[0] < right[0] ? left : right;
}

const valleys = [];  // that each torsion was in last

/// Says so when a torsion has come down from a barrier into another valley.
function sayBarriers({ angles, own }) {
  data.own.torsions.forEach(([, , name, profile], k) => {
    const known = profile.filter((v) => v !== null), n = profile.length;
    if (known.length < 2 || !Number.isFinite(own) || !Number.isFinite(angles[k])) return;
    const low = Math.min(...known), [lowest, valley] = valleyOf(profile, angles[k]), before = valleys[k];
    if (own > lowest + 0.15 * (Math.max(...known) - low)) return;  // not down yet
    valleys[k] = valley;
    if (before === undefined || before === valley) return;
    const steps = (valley - before + n) % n, way = steps <= n / 2 ? 1 : -1;
    const climbed = Math.max(...Array.from({ length: Math.min(steps, n - steps) }, (_, i) => profile.at((before + way * i) % n) ?? -Infinity)) - low;
    sayAWhile(`${name} is over a barrier of ${climbed.toFixed(climbed < 100 ? 1 : 0)} ${data.own.energy_unit}. Go on, or press "let go" for the shape behind it.`);
  });
}

function drawStrip(c, [left, top], number, [, , name, profile], angle, own) {
  const { width, height } = kStrip, right = left + width - 8, known = profile.filter((v) => v !== null);
  const title = (number ? number + "  " : "") + name + (Number.isFinite(angle) ? ` ${angle < 0 ? "−" : "+"}${Math.abs(angle).toFixed(0)}°` : "");
  c.fillStyle = data.ink;
  c.fillText(title, left, top + 7);
  if (known.length < 2 || !Number.isFinite(own) || !Number.isFinite(angle)) return;
  const low = Math.min(...known), span = Math.max(...known) - low || 1, barriers = barriersBeside(profile, angle).map((v) => v - low);
  const at = (angle_, v) => [left + (right - left) * (angle_ + 180) / 360, top + 44 - 25 * clamp((v - low) / span, 0, 1.15)];
  const curve = [...profile, profile[0]].map((v, k) => at(k / profile.length * 360 - 180, v ?? NaN));
  strokeLines(c, [[[left, top + 45], [right, top + 45]]], kGrey, 0.5);
  strokeLines(c, [curve.filter((place) => Number.isFinite(place[1])).map(([x, y]) => [x, y])], kGrey, 0.7);  // where the grid has none
  strokeCurve(c, curve, data.energy_colour);
  for (const [shade, radius] of [["#fff", 5], [data.hand_colour, 3.5]]) strokeLines(c, [[at(angle, own), at(angle + 0.01, own)]], shade, 2 * radius);
  const text = (v) => v.toFixed(span >= 100 ? 0 : span >= 1 ? 1 : 3);
  c.fillStyle = data.ink;
  c.fillText(`${text(own - low)} ${data.own.energy_unit}, barriers ${barriers.map(text).join(", ")}`, left, top + 55);
}

/// The torsions that have a strip, in a column on a wide screen, else in a row: as many as there is room for.
function stripsOf([width, height]) {
  const narrow = width < 650, most = Math.floor(narrow ? width / kStrip.width : (height - 120) / kStrip.height);
  return [narrow, (data.own?.torsions ?? []).slice(0, Math.max(0, most))];
}

function drawStrips(frame) {
  const [narrow, shown_] = stripsOf(pictureSize().map((x) => x / letterScale())), along = narrow ? kStrip.width : 0, down = narrow ? 0 : kStrip.height;
  const size = [kStrip.width + along * (shown_.length - 1), kStrip.height + down * (shown_.length - 1)];
  element("strips").hidden = shown_.length === 0;
  if (shown_.length === 0) return;
  const [c] = context(element("strips"), ...size.map((x) => x * letterScale()));
  shown_.forEach((torsion, k) => drawStrip(c, [1 + k * along, k * down], data.own.torsions.length > 1 ? k + 1 : 0, torsion, frame.angles[k], frame.own));
}

/// The numbers of the strips, at the bonds.
function markTorsions(c, frame, place, size) {
  if (data.own.torsions.length < 2) return;
  c.textAlign = "center";
  stripsOf(size)[1].forEach(([a, b], k) => {
    const at = place(plus(sphere(frame, a), plus(sphere(frame, b), sphere(frame, a), -1), 0.5));
    for (const [shade, radius] of [["#fff", 7], [data.ink, 6]]) strokeLines(c, [[at, [at[0] + 0.01, at[1]]]], shade, 2 * radius);
    c.fillStyle = "#fff";
    c.fillText(k + 1, at[0], at[1] + 0.5);
  });
  c.textAlign = "left";
}
