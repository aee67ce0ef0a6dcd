// A sharp canvas and its frames, colours, round numbers and their text.

let frameIsRequested = false;

/** Request one `frame` of the page, however many changes precede it. */
function redraw() {
  if (frameIsRequested) return;
  frameIsRequested = true;
  requestAnimationFrame((now) => {
    frameIsRequested = false;
    frame(now);
  });
}

/** An empty canvas with as many pixels as the screen has for it; one unit is one CSS pixel. */
function clearedCanvas(canvas) {
  const density = window.devicePixelRatio;
  const { left, right, top, bottom } = canvas.getBoundingClientRect();
  // browsers round edges, not widths: a canvas of any other size would be blurred
  const columns = Math.round(right * density) - Math.round(left * density);
  const rows = Math.round(bottom * density) - Math.round(top * density);
  // setting a size clears and reallocates, so only when it changed
  if (canvas.width !== columns) canvas.width = columns;
  if (canvas.height !== rows) canvas.height = rows;
  const context = canvas.getContext("2d", { alpha: false });
  const [width, height] = [columns / density, rows / density];
  context.setTransform(density, 0, 0, density, 0, 0);
  context.fillStyle = colour("background");
  context.fillRect(0, 0, width, height);
  context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  return { context, width, height };
}

/** A colour of the style sheet, which depends on the light or dark scheme. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);
}

const PALETTE_SIZE = 7;

function massColour(mass) {
  return `series-${mass % PALETTE_SIZE}`;
}

/** Runs have the colours after those of the masses, so that no colour has two meanings. */
function trackColour(number) {
  return massColour(Math.max(...tracks.map((track) => track.positions.length)) + number);
}

/** The least of ..., 0.5, 1, 2, 5, 10, ... that is not less than `spacing`. */
function roundSpacing(spacing) {
  const power = 10 ** Math.floor(Math.log10(spacing));
  return power * ([1, 2, 5].find((digit) => digit * power >= spacing) ?? 10);
}

/** The multiples of `spacing` from `low` to `high`, each with its text. */
function ticks(low, high, spacing) {
  const marks = [];
  for (let k = Math.ceil(low / spacing); k * spacing <= high; k += 1) {
    marks.push({ value: k * spacing, text: withDecimals(k * spacing, spacing) });
  }
  return marks;
}

/** A number with the decimals that `spacing` needs. */
function withDecimals(value, spacing) {
  const digits = Math.min(Math.max(-Math.floor(Math.log10(spacing) + 1e-9), 0), 20);
  return value.toFixed(digits).replace("-", "−");
}

function powerOfTen(exponent) {
  const superscripts = [...String(exponent)].map((sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);
  return `10${superscripts.join("")}`;
}

/** A number with two digits and a power of ten. */
function scientific(value) {
  if (value === 0) return "0";
  const [digits, exponent] = value.toExponential(1).split("e");
  return `${digits.replace("-", "−")} × ${powerOfTen(Number(exponent))}`;
}

/** A swatch in the colour of a run, for its label. */
function swatch(number) {
  const mark = document.createElement("span");
  mark.className = "swatch";
  mark.style.background = `var(--${trackColour(number)})`;
  return mark;
}

/** Lines in a frame with their texts: columns at x, rows at y, and the quantity below. */
function drawGrid(context, { left, right, top, bottom }, columns, rows, quantity) {
  context.strokeStyle = colour("grid");
  context.fillStyle = colour("muted");
  context.lineWidth = 1;
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const [x, text] of columns) {
    line(context, [x, top], [x, bottom]);
    context.fillText(text, x, bottom + 5);
  }
  context.fillText(quantity, (left + right) / 2, bottom + 20);
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const [y, text] of rows) {
    line(context, [left, y], [right, y]);
    context.fillText(text, left - 6, y);
  }
}

function line(context, from, to) {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}
