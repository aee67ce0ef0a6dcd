// The motions: which times they cover, and where everything is at one of them.

const tracks = JSON.parse(document.getElementById("motions").textContent);

const begin = Math.min(...tracks.map((track) => track.t[0]));
const end = Math.max(...tracks.map((track) => track.t.at(-1)));

/** Number of the last sample that is not after `time`. */
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

/** Straight between samples; before the first and after the last one as there. */
function valueAt(t, values, time) {
  const k = sampleAt(t, time);
  if (time < t[0] || k === t.length - 1) return values[k];
  // t[k + 1] is after `time` and t[k] is not: equal times divide nothing by zero
  return values[k] + ((time - t[k]) / (t[k + 1] - t[k])) * (values[k + 1] - values[k]);
}

/** Where a mass is, in m; mass -1 is the pivot. */
function placeAt(track, mass, time) {
  if (mass < 0) return [0, 0];
  return track.positions[mass].map((axis) => valueAt(track.t, axis, time));
}

/** Where a mass was from one time to another: all samples between, and both ends. */
function pathOf(track, mass, from, to) {
  const [x, y] = track.positions[mass];
  const path = [placeAt(track, mass, from)];
  for (let k = sampleAt(track.t, from) + 1; k < track.t.length && track.t[k] < to; k += 1) {
    path.push([x[k], y[k]]);
  }
  path.push(placeAt(track, mass, to));
  return path;
}

function hasEnded(track, time) {
  return time > track.t.at(-1);
}

/** The largest distance between the last masses of any two runs, in m. */
function distanceApart(time) {
  const places = tracks.map((track) => placeAt(track, track.positions.length - 1, time));
  let largest = 0;
  for (const [ax, ay] of places) {
    for (const [bx, by] of places) largest = Math.max(largest, Math.hypot(ax - bx, ay - by));
  }
  return largest;
}

/** The box around all places of all runs and the pivot: its centre, width and height, in m. */
function reach() {
  const edges = [0, 1].map((axis) => {
    let [low, high] = [0, 0];
    for (const track of tracks) {
      for (const mass of track.positions) {
        for (const value of mass[axis]) {
          low = Math.min(low, value);
          high = Math.max(high, value);
        }
      }
    }
    return [low, high];
  });
  const [width, height] = edges.map(([low, high]) => high - low);
  // masses that never leave the pivot still need a scale
  const least = Math.max(width, height) * 1e-3 || 1;
  return {
    centre: edges.map(([low, high]) => (low + high) / 2),
    width: Math.max(width, least),
    height: Math.max(height, least),
  };
}
