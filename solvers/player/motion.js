// Positions and energy errors of the motions, `tracks`, at any time.

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

/** Position of a mass or, after the masses, of another point in m; -1 is the pivot. */
function positionAt(track, number, time) {
  if (number < 0) return track.positions[0].map(() => 0);
  return atTime(track, track.positions[number] ?? track.points[number - track.positions.length], time);
}

/** Components of a point at a time; one number of a component that is constant. */
function atTime(track, point, time) {
  return point.map((axis) => (typeof axis === "number" ? axis : valueAt(track.t, axis, time)));
}

/** Path of a mass between two times: all samples between them, and both ends. */
function pathOf(track, mass, from, to) {
  const axes = track.positions[mass];
  const path = [positionAt(track, mass, from)];
  for (let k = sampleAt(track.t, from) + 1; k < track.t.length && track.t[k] < to; k += 1) {
    path.push(axes.map((axis) => axis[k]));
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
  for (const a of positions) {
    for (const b of positions) largest = Math.max(largest, Math.hypot(...a.map((x, axis) => x - b[axis])));
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

/** Masses, and the points of links but rails, which have no ends; without these points the pivot. */
function visiblePoints(track) {
  const numbers = new Set(track.links.flatMap(([kind, ...ends]) => (kind === "rail" ? [] : ends)));
  const { positions, points } = track;
  const origin = points.length === 0 ? [positions[0].map(() => 0)] : [];
  return [...positions, ...points.filter((_, k) => numbers.has(positions.length + k)), ...origin];
}

/** The box around all points of all runs: its centre, width and height in m, in space also its ground. */
function boundingBox() {
  const points = tracks.flatMap(visiblePoints);
  const edges = points[0].map((_, axis) => rangeOf(points.flatMap((point) => point[axis])));
  const sides = edges.map(([low, high]) => high - low);
  // masses that never move need a scale, too
  const least = Math.max(...sides) * 1e-3 || 1;
  const centre = edges.map(([low, high]) => (low + high) / 2);
  if (sides.length === 2) {
    return { centre, width: Math.max(sides[0], least), height: Math.max(sides[1], least) };
  }
  // squares on the ground below the motion
  const spacing = roundSpacing(Math.max(...sides, least) / 6);
  const around = ([low, high]) => [spacing * Math.floor(low / spacing), spacing * Math.ceil(high / spacing)];
  const [[left, right], [near, far]] = edges.map(around);
  const ground = { left, right, near, far, bottom: edges[2][0], spacing };
  const corners = [left, right].flatMap((x) => [near, far].map((y) => [x, y, ground.bottom]));
  // the view turns, and its scale does not change
  const diameter = Math.max(2 * farthest(points, centre), 1.6 * farthest(corners, centre), least);
  return { centre, width: diameter, height: diameter, ground };
}

/** The largest distance of points in space from a centre. */
function farthest(points, centre) {
  const at = (axis, k) => (typeof axis === "number" ? axis : axis[k]);
  let largest = 0;
  for (const point of points) {
    const samples = Math.max(...point.map((axis) => axis.length ?? 1));
    for (let k = 0; k < samples; k += 1) {
      largest = Math.max(largest, Math.hypot(...point.map((axis, n) => at(axis, k) - centre[n])));
    }
  }
  return largest;
}
