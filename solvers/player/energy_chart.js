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
      if (track.energy_error === null) return;
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
    const decades = Math.ceil((20 * (this.high - this.low)) / (this.bottom - this.top));
    const seconds = roundSpacing((50 * (endTime - startTime)) / (this.right - this.left));
    const rows = ticks(this.low, this.high, decades).map(({ value }) => [this.yAt(value), powerOfTen(value)]);
    const columns = ticks(startTime, endTime, seconds).map(({ value, text }) => [this.xAt(value), text]);
    drawGrid(context, this, columns, rows, "time / s");
  }

  moveCursor(time) {
    this.cursor.style.transform = `translateX(${this.xAt(time)}px)`;
    this.cursor.style.top = `${this.top}px`;
    this.cursor.style.height = `${this.bottom - this.top}px`;
  }
}

/** Exponents of the powers of ten that enclose all errors. */
function exponentRange() {
  const sizes = tracks.flatMap((track) => (track.energy_error ?? []).map(Math.abs));
  const [least, most] = rangeOf(sizes.filter((size) => size > 0));
  if (most < 0) return [-17, -15]; // all are zero: the size of rounding
  const high = Math.ceil(Math.log10(most));
  // an error that changes sign may be arbitrarily small: twenty decades are sufficient
  const low = Math.max(Math.floor(Math.log10(least)), high - 20);
  return [Math.min(low, high - 1), high];
}
