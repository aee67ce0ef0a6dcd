// A coordinate of all runs over time, and its phase plane: curves, and a dot at the present state.

class StateChart {
  /** `valuesOf(track, number)` gives the horizontal and the vertical values of a coordinate. */
  constructor(container, valuesOf) {
    this.canvas = container.querySelector("canvas");
    this.valuesOf = valuesOf;
    // elements of their own, so that their motion redraws no curve
    this.dots = tracks.map((_, number) => {
      const dot = document.createElement("div");
      dot.className = "dot";
      dot.style.background = `var(--${trackColour(number)})`;
      container.append(dot);
      return dot;
    });
  }

  /** Show a coordinate; the names are those of the horizontal and the vertical axis. */
  show(number, [across, up], description) {
    this.curves = tracks.map((track) => this.valuesOf(track, number));
    this.ranges = [0, 1].map((axis) => withRoom(rangeOf(this.curves.flatMap((curve) => curve[axis]))));
    this.names = [across, up];
    this.canvas.setAttribute("aria-label", description);
  }

  draw() {
    const { context, width, height } = clearedCanvas(this.canvas);
    const frame = { left: MARGINS.left + 12, right: width - MARGINS.right, top: MARGINS.top, bottom: height - MARGINS.bottom };
    this.toPixels = (values) => {
      const [x, y] = values.map((value, axis) => {
        const [low, high] = this.ranges[axis];
        return (value - low) / (high - low);
      });
      return [frame.left + x * (frame.right - frame.left), frame.bottom - y * (frame.bottom - frame.top)];
    };
    const marks = (axis, pixels, room) => {
      const [low, high] = this.ranges[axis];
      return ticks(low, high, roundSpacing((room * (high - low)) / pixels));
    };
    const columns = marks(0, frame.right - frame.left, 60).map(({ value, text }) => [this.toPixels([value, 0])[0], text]);
    const rows = marks(1, frame.bottom - frame.top, 24).map(({ value, text }) => [this.toPixels([0, value])[1], text]);
    drawGrid(context, frame, columns, rows, this.names[0]);
    context.textAlign = "left";
    context.fillText(this.names[1], 4, 10);
    this.curves.forEach(([across, up], number) => {
      context.strokeStyle = colour(trackColour(number));
      context.lineWidth = 1.5;
      context.lineJoin = "round";
      context.beginPath();
      across.forEach((value, k) => context.lineTo(...this.toPixels([value, up[k]])));
      context.stroke();
    });
  }

  moveDots(time) {
    if (!this.toPixels) return; // before it is drawn
    tracks.forEach(({ t }, number) => {
      const state = this.curves[number].map((values) => valueAt(t, values, time));
      const [x, y] = this.toPixels(state);
      this.dots[number].style.transform = `translate(${x}px, ${y}px)`;
    });
  }
}

/** A range with room at its ends; a value that never changes has a range, too. */
function withRoom([low, high]) {
  const room = 0.05 * (high - low) || 0.1 * Math.abs(low) || 1;
  return [low - room, high + room];
}

/** The letter with a dot over it, before its index. */
function rateOf(label) {
  const [letter, ...index] = label;
  return `${letter}\u0307${index.join("")}`;
}

/** The label of an axis. */
function inUnit(label, unit) {
  if (unit === "1") return label;
  return `${label} / ${unit.includes("/") ? `(${unit})` : unit}`;
}
