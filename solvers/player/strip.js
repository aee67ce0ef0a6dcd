// The energy error of all runs over time, on a logarithmic scale, with a cursor.

class Strip {
  constructor(host) {
    this.canvas = host.querySelector("canvas");
    // the cursor is an element of its own: moving it redraws no curve
    this.cursor = host.querySelector("#cursor");
    [this.low, this.high] = decades();
    this.left = FRAME.left;
    this.top = 8;
  }

  get right() {
    return this.canvas.clientWidth - FRAME.right;
  }

  get bottom() {
    return this.canvas.clientHeight - FRAME.bottom;
  }

  xAt(time) {
    return this.left + ((time - begin) / (end - begin)) * (this.right - this.left);
  }

  timeAt(x) {
    return begin + ((x - this.left) / (this.right - this.left)) * (end - begin);
  }

  yAt(exponent) {
    const part = (exponent - this.low) / (this.high - this.low);
    return this.bottom - part * (this.bottom - this.top);
  }

  draw() {
    const { pen } = cleanSheet(this.canvas);
    this.drawGrid(pen);
    pen.save();
    pen.beginPath();
    pen.rect(this.left, this.top - 1, this.right - this.left, this.bottom - this.top + 2);
    pen.clip();
    tracks.forEach((track, number) => {
      pen.strokeStyle = colour(trackColour(number));
      pen.lineWidth = 1.75;
      pen.lineJoin = "round";
      pen.beginPath();
      track.t.forEach((time, k) => {
        // no error at all has no logarithm, and no place in the chart
        const size = Math.abs(track.energy_error[k]);
        if (size > 0) pen.lineTo(this.xAt(time), this.yAt(Math.log10(size)));
      });
      pen.stroke();
    });
    pen.restore();
  }

  drawGrid(pen) {
    pen.strokeStyle = colour("grid");
    pen.fillStyle = colour("faint");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const decade = Math.ceil((20 * (this.high - this.low)) / (this.bottom - this.top));
    for (const { value } of ticks(this.low, this.high, decade)) {
      const y = this.yAt(value);
      line(pen, [this.left, y], [this.right, y]);
      pen.fillText(powerOfTen(value), this.left - 6, y);
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const step = roundStep((50 * (end - begin)) / (this.right - this.left));
    for (const { value, text } of ticks(begin, end, step)) {
      const x = this.xAt(value);
      line(pen, [x, this.top], [x, this.bottom]);
      pen.fillText(text, x, this.bottom + 5);
    }
    pen.fillText("time / s", (this.left + this.right) / 2, this.bottom + 20);
  }

  moveCursor(time) {
    this.cursor.style.transform = `translateX(${this.xAt(time)}px)`;
    this.cursor.style.top = `${this.top}px`;
    this.cursor.style.height = `${this.bottom - this.top}px`;
  }
}

/** The powers of ten between which all errors lie, as whole exponents. */
function decades() {
  let [least, most] = [Infinity, 0];
  for (const track of tracks) {
    for (const signed of track.energy_error) {
      const size = Math.abs(signed);
      if (size > 0) least = Math.min(least, size);
      most = Math.max(most, size);
    }
  }
  if (most === 0) return [-17, -15]; // rounding is the least error there is to be seen
  const high = Math.ceil(Math.log10(most));
  // an error that crosses zero comes as near to it as one likes: twenty decades are enough
  const low = Math.max(Math.floor(Math.log10(least)), high - 20);
  return [Math.min(low, high - 1), high];
}
