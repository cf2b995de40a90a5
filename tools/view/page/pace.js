// How much is drawn for each picture. Where it is drawn without a graphics card, a picture that moves gets fewer pixels, so
// that some thirty come in a second, and all of them when it rests. Curves that grow are drawn less often.

const kMostMilliseconds = 31;  // of a picture that moves
const kRestMilliseconds = 250;
const kCurveMilliseconds = [100, 300];  // the second where pictures have fewer pixels
const kLeastSharp = 0.4;
let sharp = 1;            // the part of the screen's pixels, along a side, that a picture in motion has
let lastCost = 0;         // milliseconds until the browser wanted the next picture
let meanCost = 0;         // alike, of the last few that moved
let movedAt = -Infinity;  // when the picture was drawn last
let curvesAt = -Infinity;
let resting = null;
let curvesLater = null;

/// All pixels for the next picture.
function sharpen() {
  movedAt = -Infinity;
  drawn = null;
}

/// The part of the pixels for the picture that is drawn now.
function sharpness() {
  const now = performance.now(), moves = now - movedAt < kRestMilliseconds + lastCost;
  movedAt = now;
  clearTimeout(resting);
  if (!moves) {
    sharp = Math.min(1, 1.25 * sharp);
    meanCost = 0;
  } else if (meanCost > kMostMilliseconds) {
    sharp = Math.max(kLeastSharp, 0.8 * sharp);
    meanCost = 0;
  }
  requestAnimationFrame(() => {
    lastCost = performance.now() - now;
    if (moves) meanCost += (Math.min(kRestMilliseconds, lastCost) - meanCost) / 8;
  });
  if (!moves || sharp === 1) return 1;
  resting = setTimeout(() => { sharpen(); drawSoon(); }, kRestMilliseconds);
  return sharp;
}

/// Whether the curves are drawn with this picture; if not, they are soon.
function curvesAreDue() {
  const now = performance.now(), wait = following() ? curvesAt + kCurveMilliseconds[Number(sharp < 1)] - now : 0;
  if (wait > 0) {
    curvesLater ??= setTimeout(drawSoon, wait);
    return false;
  }
  clearTimeout(curvesLater);
  curvesLater = null;
  curvesAt = now;
  return true;
}
