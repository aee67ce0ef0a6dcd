// One run: its masses and links at one time, over a grid in metres.

/** Duration of traces in s. */
const TRACE_SECONDS = 2;
/** Number of segments of a trace, each paler than the next. */
const SEGMENTS = 40;
const MASS_RADIUS = 8;
const MARGINS = { left: 44, right: 14, top: 24, bottom: 36 };

class Panel {
  /** `boxAt` gives the box to show at a time; that of the whole motion is `box`. */
  constructor(track, number, box, boxAt) {
    this.track = track;
    this.boxAt = boxAt;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.isInSpace = box.centre.length === 3;
    const view = this.isInSpace ? " in space; the arrow keys turn the view" : "";
    this.canvas.setAttribute("aria-label", `Motion of ${track.label}${view}`);
    if (this.isInSpace) addTurning(this.canvas);
    // a wide motion has a wide canvas; ratio and scale are the same for all runs
    const ratio = Math.min(Math.max(box.width / box.height, 1), 1.6);
    this.canvas.style.aspectRatio = String(ratio);
    const caption = document.createElement("figcaption");
    caption.append(swatch(number), track.label);
    this.figure = document.createElement("figure");
    this.figure.append(caption, this.canvas);
  }

  draw(time) {
    const { context, width, height } = clearedCanvas(this.canvas);
    const box = this.boxAt(time);
    const view = new View(box, width, height);
    if (this.isInSpace) drawGround(context, view, box.ground);
    else drawMetres(context, view);
    // rails have no ends
    context.save();
    context.beginPath();
    context.rect(view.left, view.top, view.right - view.left, view.bottom - view.top);
    context.clip();
    // a run that ends earlier than the others stays at its last position, and is pale
    const opacity = hasEnded(this.track, time) ? 0.35 : 1;
    for (const mass of this.track.positions.keys()) this.drawTrace(context, view, mass, time, opacity);
    context.globalAlpha = opacity;
    this.drawLinks(context, view, time);
    const masses = [...this.track.positions.keys()].map((mass) => [mass, positionAt(this.track, mass, time)]);
    masses.sort(([, a], [, b]) => depth(b) - depth(a)); // near masses in front of far ones
    for (const [mass, position] of masses) {
      disc(context, view.toPixels(position), MASS_RADIUS, colour(massColour(mass)));
    }
    context.restore();
  }

  drawTrace(context, view, mass, time, opacity) {
    context.strokeStyle = colour(massColour(mass));
    context.lineWidth = 2;
    context.lineJoin = "round";
    for (let segment = 0; segment < SEGMENTS; segment += 1) {
      const from = time - TRACE_SECONDS * (1 - segment / SEGMENTS);
      const to = from + TRACE_SECONDS / SEGMENTS;
      if (to <= this.track.t[0]) continue;
      context.globalAlpha = (0.85 * opacity * (segment + 1)) / SEGMENTS;
      context.beginPath();
      for (const position of pathOf(this.track, mass, from, to)) context.lineTo(...view.toPixels(position));
      context.stroke();
    }
  }

  drawLinks(context, view, time) {
    const { track } = this;
    const at = (number) => view.toPixels(positionAt(track, number, time));
    context.lineCap = "round";
    context.lineJoin = "round";
    for (const [kind, ...ends] of track.links) drawLink(context, kind, ends.map(at));
    context.lineCap = "butt";
    // joints; without further points the pivot
    const lines = track.links.filter(([kind]) => ["rod", "thread", "spring"].includes(kind));
    const ends = lines.flatMap(([, ...numbers]) => numbers);
    const joints = ends.filter((number) => number >= track.positions.length);
    const pivots = track.points.length === 0 ? [-1] : [];
    for (const number of [...joints, ...pivots]) disc(context, at(number), 4, colour("rod"));
  }
}

/** The transformation from metres to pixels, with the same scale along both axes. */
class View {
  constructor(box, width, height) {
    this.left = MARGINS.left;
    this.right = width - MARGINS.right;
    this.top = MARGINS.top;
    this.bottom = height - MARGINS.bottom;
    // room for whole masses at the edges
    const room = [this.right - this.left, this.bottom - this.top].map((side) => side - 3 * MASS_RADIUS);
    this.scale = Math.max(Math.min(room[0] / box.width, room[1] / box.height), 0);
    this.middle = [(this.left + this.right) / 2, (this.top + this.bottom) / 2];
    this.centre = flattened(box.centre);
  }

  /** Metres to pixels; y points up, and the rows of pixels are counted down. */
  toPixels(position) {
    const [x, y] = flattened(position);
    return [
      this.middle[0] + this.scale * (x - this.centre[0]),
      this.middle[1] - this.scale * (y - this.centre[1]),
    ];
  }

  /** Pixels to metres on the plane of view. */
  toMetres([x, y]) {
    return [
      this.centre[0] + (x - this.middle[0]) / this.scale,
      this.centre[1] - (y - this.middle[1]) / this.scale,
    ];
  }

  /** The visible ranges in metres, from left to right and from bottom to top. */
  visibleRanges() {
    const sides = [this.right - this.left, this.bottom - this.top];
    const halves = sides.map((side) => side / 2 / this.scale);
    return this.centre.map((middle, axis) => [middle - halves[axis], middle + halves[axis]]);
  }
}

function drawMetres(context, view) {
  if (view.scale === 0) return; // too small to show anything
  const spacing = roundSpacing(36 / view.scale);
  const [columns, rows] = view.visibleRanges().map((range, axis) =>
    ticks(...range, spacing).map(({ value, text }) => [view.toPixels([value, value])[axis], text]),
  );
  drawGrid(context, view, columns, rows, "x / m");
  context.fillText("y / m", view.left - 6, 10);
}

/** Squares on the ground below a motion in space, and the directions of the axes. */
function drawGround(context, view, { left, right, near, far, bottom, spacing }) {
  const lines = (low, high, draw) => {
    for (let k = 0; low + k * spacing <= high + spacing / 2; k += 1) draw(low + k * spacing);
  };
  const at = (x, y) => view.toPixels([x, y, bottom]);
  context.strokeStyle = colour("grid");
  context.lineWidth = 1;
  lines(left, right, (x) => line(context, at(x, near), at(x, far)));
  lines(near, far, (y) => line(context, at(left, y), at(right, y)));
  context.fillStyle = colour("muted");
  context.textAlign = "right";
  context.textBaseline = "middle";
  context.fillText(`squares of ${withDecimals(spacing, spacing)} m`, view.right, view.bottom + 20);
  drawAxes(context, [view.left, view.bottom]);
}

/** Arrows along x, y and z, and their letters. */
function drawAxes(context, [left, bottom]) {
  context.strokeStyle = colour("muted");
  context.textAlign = "center";
  ["x", "y", "z"].forEach((letter, axis) => {
    const [right, up] = flattened([0, 1, 2].map((other) => Number(other === axis)));
    line(context, [left, bottom], [left + 22 * right, bottom - 22 * up]);
    context.fillText(letter, left + 32 * right, bottom - 32 * up);
  });
}

function disc(context, centre, radius, fill) {
  context.fillStyle = fill;
  context.beginPath();
  context.arc(...centre, radius, 0, 2 * Math.PI);
  context.fill();
}
