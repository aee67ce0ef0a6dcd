// The energy error of all runs over time, on a logarithmic scale, with a cursor.

class EnergyChart {
  constructor(container) {
    this.canvas = container.querySelector("canvas");
    // the cursor is an element of its own, so that its motion redraws no curve
    this.cursor = container.querySelector("#cursor");
    [this.low, this.high] = exponentRange();
    this.left = MARGINS.left;
    this.top = 8;
  }

  get right() {
    return this.canvas.clientWidth - MARGINS.right;
  }

  get bottom() {
    return this.canvas.clientHeight - MARGINS.bottom;
  }

  xAt(time) {
    return this.left + ((time - startTime) / (endTime - startTime)) * (this.right - this.left);
  }

  timeAt(x) {
    return startTime + ((x - this.left) / (this.right - this.left)) * (endTime - startTime);
  }

  yAt(exponent) {
    const fraction = (exponent - this.low) / (this.high - this.low);
    return this.bottom - fraction * (this.bottom - this.top);
  }

  draw() {
    const { context } = clearedCanvas(this.canvas);
    this.drawGrid(context);
    context.save();
    context.beginPath();
    context.rect(this.left, this.top - 1, this.right - this.left, this.bottom - this.top + 2);
    context.clip();
    tracks.forEach((track, number) => {
      context.strokeStyle = colour(trackColour(number));
      context.lineWidth = 1.75;
      context.lineJoin = "round";
      context.beginPath();
      track.t.forEach((time, k) => {
        // zero has no logarithm and is left out
        const size = Math.abs(track.energy_error[k]);
        if (size > 0) context.lineTo(this.xAt(time), this.yAt(Math.log10(size)));
      });
      context.stroke();
    });
    context.restore();
  }

  drawGrid(context) {
    context.strokeStyle = colour("grid");
    context.fillStyle = colour("muted");
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    const spacing = Math.ceil((20 * (this.high - this.low)) / (this.bottom - this.top));
    for (const { value } of ticks(this.low, this.high, spacing)) {
      const y = this.yAt(value);
      line(context, [this.left, y], [this.right, y]);
      context.fillText(powerOfTen(value), this.left - 6, y);
    }
    context.textAlign = "center";
    context.textBaseline = "top";
    const seconds = roundSpacing((50 * (endTime - startTime)) / (this.right - this.left));
    for (const { value, text } of ticks(startTime, endTime, seconds)) {
      const x = this.xAt(value);
      line(context, [x, this.top], [x, this.bottom]);
      context.fillText(text, x, this.bottom + 5);
    }
    context.fillText("time / s", (this.left + this.right) / 2, this.bottom + 20);
  }

  moveCursor(time) {
    this.cursor.style.transform = `translateX(${this.xAt(time)}px)`;
    this.cursor.style.top = `${this.top}px`;
    this.cursor.style.height = `${this.bottom - this.top}px`;
  }
}

/** Exponents of the powers of ten that enclose all errors. */
function exponentRange() {
  let [least, most] = [Infinity, 0];
  for (const track of tracks) {
    for (const signed of track.energy_error) {
      const size = Math.abs(signed);
      if (size > 0) least = Math.min(least, size);
      most = Math.max(most, size);
    }
  }
  if (most === 0) return [-17, -15]; // the size of rounding
  const high = Math.ceil(Math.log10(most));
  // an error that changes sign may be arbitrarily small: twenty decades are sufficient
  const low = Math.max(Math.floor(Math.log10(least)), high - 20);
  return [Math.min(low, high - 1), high];
}
