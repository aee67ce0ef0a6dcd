// One run: its masses, rods and springs at a time, over a grid in metres.

/** How long a trace stays, in s. */
const TRAIL = 2;
/** A trace is drawn in so many pieces, each paler than the next. */
const PIECES = 40;
const BOB = 8;
const FRAME = { left: 44, right: 14, top: 24, bottom: 36 };

class Panel {
  constructor(track, number, box) {
    this.track = track;
    this.box = box;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `Motion of ${track.label}`);
    // a wide motion gets a wide canvas; the same for all runs, and so is the scale
    const shape = Math.min(Math.max(box.width / box.height, 1), 1.6);
    this.canvas.style.aspectRatio = String(shape);
    const caption = document.createElement("figcaption");
    caption.append(swatch(number), track.label);
    this.figure = document.createElement("figure");
    this.figure.append(caption, this.canvas);
  }

  draw(time) {
    const { pen, width, height } = cleanSheet(this.canvas);
    const view = new View(this.box, width, height);
    drawGrid(pen, view);
    // a run that ended earlier than the others stays where it was, and is pale
    const strength = hasEnded(this.track, time) ? 0.35 : 1;
    for (const mass of this.track.positions.keys()) this.drawTrace(pen, view, mass, time, strength);
    pen.globalAlpha = strength;
    this.drawJoints(pen, view, time);
    for (const mass of this.track.positions.keys()) {
      disc(pen, view.at(placeAt(this.track, mass, time)), BOB, colour(massColour(mass)));
    }
    pen.globalAlpha = 1;
  }

  drawTrace(pen, view, mass, time, strength) {
    pen.strokeStyle = colour(massColour(mass));
    pen.lineWidth = 2;
    pen.lineJoin = "round";
    for (let piece = 0; piece < PIECES; piece += 1) {
      const from = time - TRAIL * (1 - piece / PIECES);
      const to = from + TRAIL / PIECES;
      if (to <= this.track.t[0]) continue;
      pen.globalAlpha = (0.85 * strength * (piece + 1)) / PIECES;
      pen.beginPath();
      for (const place of pathOf(this.track, mass, from, to)) pen.lineTo(...view.at(place));
      pen.stroke();
    }
  }

  drawJoints(pen, view, time) {
    const ends = (pair) => pair.map((mass) => view.at(placeAt(this.track, mass, time)));
    pen.strokeStyle = colour("rod");
    pen.lineWidth = 3;
    pen.lineCap = "round";
    for (const pair of this.track.links) line(pen, ...ends(pair));
    pen.lineWidth = 2;
    for (const pair of this.track.springs) zigzag(pen, ...ends(pair));
    pen.lineCap = "butt";
    disc(pen, view.at([0, 0]), 4, colour("rod"));
  }
}

/** From metres to pixels, the same along both axes. */
class View {
  constructor(box, width, height) {
    this.left = FRAME.left;
    this.right = width - FRAME.right;
    this.top = FRAME.top;
    this.bottom = height - FRAME.bottom;
    // whole bobs stay inside
    const room = [this.right - this.left, this.bottom - this.top].map((side) => side - 3 * BOB);
    this.scale = Math.max(Math.min(room[0] / box.width, room[1] / box.height), 0);
    this.middle = [(this.left + this.right) / 2, (this.top + this.bottom) / 2];
    this.centre = box.centre;
  }

  /** Metres to pixels: y points up, and a canvas's pixels are counted down. */
  at([x, y]) {
    return [
      this.middle[0] + this.scale * (x - this.centre[0]),
      this.middle[1] - this.scale * (y - this.centre[1]),
    ];
  }

  /** What can be seen, in metres: from left to right, and from bottom to top. */
  edges() {
    const across = (this.right - this.left) / 2 / this.scale;
    const up = (this.bottom - this.top) / 2 / this.scale;
    return [
      [this.centre[0] - across, this.centre[0] + across],
      [this.centre[1] - up, this.centre[1] + up],
    ];
  }
}

function drawGrid(pen, view) {
  if (view.scale === 0) return; // too small for anything to be seen
  const [horizontal, vertical] = view.edges();
  const step = roundStep(36 / view.scale);
  pen.strokeStyle = colour("grid");
  pen.fillStyle = colour("faint");
  pen.lineWidth = 1;
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const { value, text } of ticks(...horizontal, step)) {
    const [x] = view.at([value, 0]);
    line(pen, [x, view.top], [x, view.bottom]);
    pen.fillText(text, x, view.bottom + 5);
  }
  pen.fillText("x / m", view.middle[0], view.bottom + 20);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const { value, text } of ticks(...vertical, step)) {
    const [, y] = view.at([0, value]);
    line(pen, [view.left, y], [view.right, y]);
    pen.fillText(text, view.left - 6, y);
  }
  pen.fillText("y / m", view.left - 6, 10);
}

function disc(pen, centre, radius, fill) {
  pen.fillStyle = fill;
  pen.beginPath();
  pen.arc(...centre, radius, 0, 2 * Math.PI);
  pen.fill();
}

/** A spring: as many teeth however long it is, so that stretching it shows. */
function zigzag(pen, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy) || 1;
  const [acrossX, acrossY] = [(-7 * dy) / length, (7 * dx) / length];
  const teeth = 16;
  pen.beginPath();
  pen.moveTo(ax, ay);
  pen.lineTo(ax + 0.1 * dx, ay + 0.1 * dy);
  for (let k = 0; k < teeth; k += 1) {
    const along = 0.1 + (0.8 * (k + 0.5)) / teeth;
    const side = k % 2 ? 1 : -1;
    pen.lineTo(ax + along * dx + side * acrossX, ay + along * dy + side * acrossY);
  }
  pen.lineTo(ax + 0.9 * dx, ay + 0.9 * dy);
  pen.lineTo(bx, by);
  pen.stroke();
}
