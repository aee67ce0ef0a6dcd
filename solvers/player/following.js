// A view that follows a motion whose path is much larger than the system.

/** Ratio of the whole motion's size to that of a configuration from which on a view can follow. */
const FAR = 5;

/** The visible points of a run at one time: the centre of the box around them, and its diagonal in m. */
function configuration(track, time) {
  const points = visiblePoints(track).map((point) => atTime(track, point, time));
  const edges = points[0].map((_, axis) => rangeOf(points.map((point) => point[axis])));
  return {
    centre: edges.map(([low, high]) => (low + high) / 2),
    size: Math.hypot(...edges.map(([low, high]) => high - low)),
  };
}

/** The largest size of a configuration of any run, in m. */
function largestConfiguration() {
  const times = Array.from({ length: 101 }, (_, k) => startTime + (k / 100) * (endTime - startTime));
  return Math.max(...tracks.flatMap((track) => times.map((time) => configuration(track, time).size)));
}

/** Whether the whole motion is so large that its configurations are small in it. */
function goesFar(box, size) {
  return size > 0 && Math.max(box.width, box.height) > FAR * size;
}

/** The box around a run at one time, twice as large as its largest configuration. */
function boxAround(track, time, size, { ground }) {
  const { centre } = configuration(track, time);
  const sides = { centre, width: 2 * size, height: 2 * size };
  if (!ground) return sides;
  const spacing = roundSpacing(size / 4);
  const [[left, right], [near, far]] = centre.map((middle) =>
    [-0.7, 0.7].map((part) => spacing * Math.round((middle + part * size) / spacing)),
  );
  return { ...sides, ground: { left, right, near, far, bottom: ground.bottom, spacing } };
}
