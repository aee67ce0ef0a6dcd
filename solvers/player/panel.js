// One run: its masses, rods and springs at one time, over a grid in metres.

/** Duration of traces in s. */
const TRACE_SECONDS = 2;
/** Number of segments of a trace, each paler than the next. */
const SEGMENTS = 40;
const MASS_RADIUS = 8;
const MARGINS = { left: 44, right: 14, top: 24, bottom: 36 };

class Panel {
  constructor(track, number, box) {
    this.track = track;
    this.box = box;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `Motion of ${track.label}`);
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
    const view = new View(this.box, width, height);
    drawMetres(context, view);
    // a run that ends earlier than the others stays at its last position, and is pale
    const opacity = hasEnded(this.track, time) ? 0.35 : 1;
    for (const mass of this.track.positions.keys()) this.drawTrace(context, view, mass, time, opacity);
    context.globalAlpha = opacity;
    this.drawLinks(context, view, time);
    for (const mass of this.track.positions.keys()) {
      disc(context, view.toPixels(positionAt(this.track, mass, time)), MASS_RADIUS, colour(massColour(mass)));
    }
    context.globalAlpha = 1;
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
    const ends = (pair) => pair.map((mass) => view.toPixels(positionAt(this.track, mass, time)));
    context.strokeStyle = colour("rod");
    context.lineWidth = 3;
    context.lineCap = "round";
    for (const pair of this.track.links) line(context, ...ends(pair));
    context.lineWidth = 2;
    for (const pair of this.track.springs) zigzag(context, ...ends(pair));
    context.lineCap = "butt";
    disc(context, view.toPixels([0, 0]), 4, colour("rod"));
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
    this.centre = box.centre;
  }

  /** Metres to pixels; y points up, and the rows of pixels are counted down. */
  toPixels([x, y]) {
    return [
      this.middle[0] + this.scale * (x - this.centre[0]),
      this.middle[1] - this.scale * (y - this.centre[1]),
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

function disc(context, centre, radius, fill) {
  context.fillStyle = fill;
  context.beginPath();
  context.arc(...centre, radius, 0, 2 * Math.PI);
  context.fill();
}

/** A spring: the number of teeth does not depend on its length, so that its extension is visible. */
function zigzag(context, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy) || 1;
  const [acrossX, acrossY] = [(-7 * dy) / length, (7 * dx) / length];
  const teeth = 16;
  context.beginPath();
  context.moveTo(ax, ay);
  context.lineTo(ax + 0.1 * dx, ay + 0.1 * dy);
  for (let k = 0; k < teeth; k += 1) {
    const along = 0.1 + (0.8 * (k + 0.5)) / teeth;
    const side = k % 2 ? 1 : -1;
    context.lineTo(ax + along * dx + side * acrossX, ay + along * dy + side * acrossY);
  }
  context.lineTo(ax + 0.9 * dx, ay + 0.9 * dy);
  context.lineTo(bx, by);
  context.stroke();
}
