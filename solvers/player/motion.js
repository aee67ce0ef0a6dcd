// The motions: their time span, and positions and energy errors at any time.

const tracks = JSON.parse(document.getElementById("motions").textContent);

const startTime = Math.min(...tracks.map((track) => track.t[0]));
const endTime = Math.max(...tracks.map((track) => track.t.at(-1)));

/** Index of the last sample that is not after `time`. */
function sampleAt(t, time) {
  let low = 0;
  let high = t.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
}

/** Linear interpolation between samples; constant before the first and after the last one. */
function valueAt(t, values, time) {
  const k = sampleAt(t, time);
  if (time < t[0] || k === t.length - 1) return values[k];
  // t[k + 1] is after `time` and t[k] is not, so that equal times cause no division by zero
  return values[k] + ((time - t[k]) / (t[k + 1] - t[k])) * (values[k + 1] - values[k]);
}

/** Position of a mass in m; mass -1 is the pivot. */
function positionAt(track, mass, time) {
  if (mass < 0) return [0, 0];
  return track.positions[mass].map((axis) => valueAt(track.t, axis, time));
}

/** Path of a mass between two times: all samples between them, and both ends. */
function pathOf(track, mass, from, to) {
  const [x, y] = track.positions[mass];
  const path = [positionAt(track, mass, from)];
  for (let k = sampleAt(track.t, from) + 1; k < track.t.length && track.t[k] < to; k += 1) {
    path.push([x[k], y[k]]);
  }
  path.push(positionAt(track, mass, to));
  return path;
}

function hasEnded(track, time) {
  return time > track.t.at(-1);
}

/** The largest distance between the last masses of any two runs, in m. */
function largestDistance(time) {
  const positions = tracks.map((track) => positionAt(track, track.positions.length - 1, time));
  let largest = 0;
  for (const [ax, ay] of positions) {
    for (const [bx, by] of positions) largest = Math.max(largest, Math.hypot(ax - bx, ay - by));
  }
  return largest;
}

/** The least and the largest of numbers, however many; infinite for none. */
function rangeOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high];
}

/** The box around all positions of all runs and the pivot: its centre, width and height in m. */
function boundingBox() {
  const masses = tracks.flatMap((track) => track.positions);
  const edges = [0, 1].map((axis) => rangeOf([0, ...masses.flatMap((mass) => mass[axis])]));
  const [width, height] = edges.map(([low, high]) => high - low);
  // masses that never leave the pivot need a scale, too
  const least = Math.max(width, height) * 1e-3 || 1;
  return {
    centre: edges.map(([low, high]) => (low + high) / 2),
    width: Math.max(width, least),
    height: Math.max(height, least),
  };
}
