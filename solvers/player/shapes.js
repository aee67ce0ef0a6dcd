// Links: lines and areas through points, in pixels.

/** Width of the line of each kind in pixels. */
const LINE_WIDTHS = { rod: 3, thread: 1.5, spring: 2, rail: 1, plate: 2, ring: 2, wheel: 2 };

function drawLink(context, kind, points) {
  context.strokeStyle = colour(kind === "rail" ? "muted" : "rod");
  context.fillStyle = colour("area");
  context.lineWidth = LINE_WIDTHS[kind];
  context.beginPath();
  for (const point of outline(kind, points)) context.lineTo(...point);
  if (kind === "plate") context.closePath();
  if (["plate", "wheel"].includes(kind)) context.fill();
  context.stroke();
}

/** The points of a line; a wheel's starts with its spoke. */
function outline(kind, points) {
  if (kind === "spring") return points.slice(1).flatMap((point, k) => zigzag(points[k], point));
  if (kind === "ring") return ellipse(points);
  if (kind === "wheel") return [points[0], ...ellipse(points)];
  if (kind === "rail") return withoutEnds(points);
  return points;
}

/** A circle from any direction: its centre, and two points of it a quarter turn apart. */
function ellipse([centre, first, second]) {
  return Array.from({ length: 65 }, (_, k) => {
    const [cos, sin] = [Math.cos((k * Math.PI) / 32), Math.sin((k * Math.PI) / 32)];
    return centre.map((c, axis) => c + cos * (first[axis] - c) + sin * (second[axis] - c));
  });
}

/** The line through two points, far beyond the edges of a canvas. */
function withoutEnds([[ax, ay], [bx, by]]) {
  const [dx, dy] = [bx - ax, by - ay];
  const factor = 1e4 / (Math.hypot(dx, dy) || 1);
  return [-factor, factor].map((s) => [ax + s * dx, ay + s * dy]);
}

/** A spring: the number of teeth does not depend on its length, so that its extension is visible. */
function zigzag([ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy) || 1;
  const [acrossX, acrossY] = [(-7 * dy) / length, (7 * dx) / length];
  const teeth = 16;
  const path = [[ax, ay], [ax + 0.1 * dx, ay + 0.1 * dy]];
  for (let k = 0; k < teeth; k += 1) {
    const along = 0.1 + (0.8 * (k + 0.5)) / teeth;
    const side = k % 2 ? 1 : -1;
    path.push([ax + along * dx + side * acrossX, ay + along * dy + side * acrossY]);
  }
  path.push([ax + 0.9 * dx, ay + 0.9 * dy], [bx, by]);
  return path;
}
