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
    drawGrid(context, view);
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
    const across = (this.right - this.left) / 2 / this.scale;
    const up = (this.bottom - this.top) / 2 / this.scale;
    return [
      [this.centre[0] - across, this.centre[0] + across],
      [this.centre[1] - up, this.centre[1] + up],
    ];
  }
}

function drawGrid(context, view) {
  if (view.scale === 0) return; // too small to show anything
  const [horizontal, vertical] = view.visibleRanges();
  const spacing = roundSpacing(36 / view.scale);
  context.strokeStyle = colour("grid");
  context.fillStyle = colour("muted");
  context.lineWidth = 1;
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const { value, text } of ticks(...horizontal, spacing)) {
    const [x] = view.toPixels([value, 0]);
    line(context, [x, view.top], [x, view.bottom]);
    context.fillText(text, x, view.bottom + 5);
  }
  context.fillText("x / m", view.middle[0], view.bottom + 20);
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const { value, text } of ticks(...vertical, spacing)) {
    const [, y] = view.toPixels([0, value]);
    line(context, [view.left, y], [view.right, y]);
    context.fillText(text, view.left - 6, y);
  }
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
