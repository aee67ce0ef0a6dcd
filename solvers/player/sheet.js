// What every drawing needs: a sharp canvas, colours, round numbers and how to write them.

/** An empty canvas with as many pixels as the screen has for it; one unit is one CSS pixel. */
function cleanSheet(canvas) {
  const density = window.devicePixelRatio;
  const { left, right, top, bottom } = canvas.getBoundingClientRect();
  // the screen rounds edges, not widths: a canvas of any other size would be blurred
  const columns = Math.round(right * density) - Math.round(left * density);
  const rows = Math.round(bottom * density) - Math.round(top * density);
  // setting a size clears and reallocates, so only when it changed
  if (canvas.width !== columns) canvas.width = columns;
  if (canvas.height !== rows) canvas.height = rows;
  const pen = canvas.getContext("2d", { alpha: false });
  const [width, height] = [columns / density, rows / density];
  pen.setTransform(density, 0, 0, density, 0, 0);
  pen.fillStyle = colour("paper");
  pen.fillRect(0, 0, width, height);
  pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  return { pen, width, height };
}

/** A colour of the style sheet, which knows whether the page is light or dark. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);
}

const PALETTE_SIZE = 7;

function massColour(mass) {
  return `series-${mass % PALETTE_SIZE}`;
}

/** Runs take the colours after those of the masses, so that none of them means two things. */
function trackColour(number) {
  return massColour(Math.max(...tracks.map((track) => track.positions.length)) + number);
}

/** The least of ..., 0.5, 1, 2, 5, 10, ... that is not less than `rough`. */
function roundStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5].find((digit) => digit * power >= rough) ?? 10);
}

/** The multiples of `step` from `low` to `high`, each with its text. */
function ticks(low, high, step) {
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k += 1) {
    found.push({ value: k * step, text: fixed(k * step, step) });
  }
  return found;
}

/** A number with so many digits after the point that `step` would show. */
function fixed(value, step) {
  const digits = Math.min(Math.max(-Math.floor(Math.log10(step) + 1e-9), 0), 20);
  return value.toFixed(digits).replace("-", "−");
}

function powerOfTen(exponent) {
  const raised = [...String(exponent)].map((sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);
  return `10${raised.join("")}`;
}

/** A number as two digits and a power of ten. */
function scientific(value) {
  if (value === 0) return "0";
  const [digits, exponent] = value.toExponential(1).split("e");
  return `${digits.replace("-", "−")} × ${powerOfTen(Number(exponent))}`;
}

/** A small mark in a run's colour, for its label. */
function swatch(number) {
  const mark = document.createElement("span");
  mark.className = "swatch";
  mark.style.background = `var(--${trackColour(number)})`;
  return mark;
}

function line(pen, from, to) {
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
}
