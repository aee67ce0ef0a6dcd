// A page that integrates: controls, dragging, and the address that keeps the state.

const element = (name) => document.getElementById(name);
const clock = { time: 0, playing: false, lastFrame: null };
/** Seconds of the energy chart. */
const CHART_SECONDS = 10;
const CHART = { left: MARGINS.left, right: MARGINS.right, top: 8, bottom: MARGINS.bottom };
let panels = [];
let box;
let dragged = null;

/** A panel that also shows the motions beside the first one. */
class LivePanel extends Panel {
  constructor(run, number) {
    super(run.track, number, box, () => box);
    this.run = run;
    this.figure.prepend(runControls(run, number));
    this.addDragging();
  }

  draw(time) {
    super.draw(time);
    const { clientWidth, clientHeight } = this.canvas;
    const view = new View(box, clientWidth, clientHeight);
    this.canvas.dataset.masses = JSON.stringify(this.run.motions[0].masses(time).map((place) => view.toPixels(place)));
  }

  drawLinks(context, view, time) {
    const { track } = this;
    const opacity = context.globalAlpha;
    context.globalAlpha = opacity * 0.25;
    for (const motion of this.run.motions.slice(1)) {
      this.track = { ...track, positions: motion.masses(time), points: motion.points(time) };
      super.drawLinks(context, view, time);
    }
    this.track = track;
    context.globalAlpha = opacity;
    super.drawLinks(context, view, time);
  }

  addDragging() {
    const { canvas } = this;
    const at = (event) => {
      const { left, top, width, height } = canvas.getBoundingClientRect();
      return [new View(box, width, height), [event.clientX - left, event.clientY - top]];
    };
    canvas.addEventListener(
      "pointerdown",
      (event) => {
        const [view, pointer] = at(event);
        const distance = (place) => Math.hypot(...view.toPixels(place).map((x, axis) => x - pointer[axis]));
        const distances = this.run.motions[0].masses(clock.time).map(distance);
        const mass = distances.indexOf(Math.min(...distances));
        if (distances[mass] > 3 * MASS_RADIUS) return;
        dragged = { mass, pointer: event.pointerId };
        setPlaying(false);
        canvas.setPointerCapture(event.pointerId);
        event.stopImmediatePropagation(); // it does not turn the view
      },
      true,
    );
    canvas.addEventListener(
      "pointermove",
      (event) => {
        if (dragged?.pointer !== event.pointerId) return;
        const [view, pointer] = at(event);
        start.set(coordinatesAt(this.run.motions[0], dragged.mass, view.toMetres(pointer)));
        start.fill(0, count);
        restart();
        event.stopImmediatePropagation();
      },
      true,
    );
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, () => {
        if (dragged) setPlaying(true);
        dragged = null;
      });
    }
  }
}

/** An input with its label and, for a slider, its value. */
function field(container, label, input, text) {
  const name = document.createElement("label");
  name.textContent = label;
  input.id = `${container.id}-${container.childElementCount}`;
  name.htmlFor = input.id;
  container.append(name, input);
  if (!text) return;
  const value = document.createElement("output");
  value.className = "number";
  const show = () => (value.textContent = text());
  input.addEventListener("input", show);
  show();
  container.append(value);
}

/** The choice of the method and the step size of a run. */
function runControls(run, number) {
  const container = document.createElement("div");
  container.id = `run-${number}`;
  container.className = "run";
  const method = document.createElement("select");
  const methods = Object.entries(system.methods);
  method.append(...methods.map(([name, { title }]) => new Option(title, name, false, name === run.name)));
  method.addEventListener("change", () => {
    run.name = method.value;
    restart();
  });
  field(container, "Method", method);
  const h = document.createElement("input");
  Object.assign(h, { type: "range", min: "-4", max: "-0.3", step: "0.05", value: String(Math.log10(run.h)) });
  h.addEventListener("input", () => {
    run.h = Number((10 ** h.value).toPrecision(2));
    restart();
  });
  field(container, "Step", h, () => `${Number((10 ** h.value).toPrecision(2))} s`);
  return container;
}

/** Start all runs anew; the view stays, unless it was not chosen yet. */
function restart() {
  clock.time = 0;
  const copies = Math.min(Math.max(Math.round(Number(element("copies").value)) || 1, 1), 100);
  for (const run of runs) run.restart(copies);
  start.set(runs[0].motions[0].values.slice(0, count)); // a start that constraints permit
  [...element("start").querySelectorAll("input")].forEach((input, k) => {
    if (input !== document.activeElement) input.value = String(Number(start[k].toPrecision(6)));
  });
  const labels = runs.map(({ name, h }) => `${system.methods[name].title}, h = ${h} s`);
  runs.forEach((run, k) => (run.track.label = labels[k]));
  // a page inside a notebook has no address
  if (location.protocol !== "about:") history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(settings()))}`);
  redraw();
}

function settings() {
  return {
    start: [...start],
    parameters: [...parameters],
    runs: runs.map(({ name, h }) => [name, h]),
    copies: Number(element("copies").value),
  };
}

/** The settings in the page's address, else those of the scene. */
function initialSettings() {
  const initial = { runs: [[system.method, system.h]], copies: 1 };
  try {
    const given = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    const numbers = (list, length) => list?.length === length && list.every(Number.isFinite);
    if (numbers(given.start, 2 * count) && numbers(given.parameters, parameters.length)) {
      start.set(given.start);
      parameters.set(given.parameters);
    }
    const known = ([name, h]) => name in system.methods && h >= 1e-4 && h <= 1;
    if (given.runs?.length > 0 && given.runs.every(known)) initial.runs = given.runs.slice(0, 2);
    initial.copies = given.copies || 1;
  } catch {
    // another address
  }
  return initial;
}

/** The runs with their panels; the view is a box around the motion from here on. */
function build(methods) {
  runs.splice(0, runs.length, ...methods.map(([name, h]) => new Run(name, h)));
  tracks.splice(0, tracks.length, ...runs.map(({ track }) => track));
  for (const run of runs) run.restart(1);
  const [first] = runs;
  for (let time = 0; time < system.duration && !first.failed; time += 0.1) first.advance(time);
  box = boundingBox();
  panels = runs.map((run, number) => new LivePanel(run, number));
  element("panels").replaceChildren(...panels.map(({ figure }) => figure));
  element("turning").hidden = !panels[0].isInSpace;
  element("legend").replaceChildren(
    ...runs.map((_, number) => {
      const entry = document.createElement("li");
      entry.append(swatch(number), document.createElement("span"));
      return entry;
    }),
  );
  restart();
}

function frame(now) {
  if (clock.playing) {
    // a page that was hidden, or a slow one, falls behind instead of jumping
    if (clock.lastFrame !== null) clock.time += Number(element("speed").value) * Math.min((now - clock.lastFrame) / 1000, 0.1);
    clock.lastFrame = now;
    const isFast = runs.map((run) => run.advance(clock.time)).every(Boolean);
    if (!isFast) clock.time = Math.min(...runs.map(({ time }) => time));
    element("status").textContent = isFast ? "" : "slower than the selected speed";
    redraw();
  }
  panels.forEach((panel, number) => {
    panel.figure.querySelector("figcaption").lastChild.textContent = panel.track.label;
    panel.draw(runs[number].time);
  });
  drawEnergy();
  element("time").textContent = `${clock.time.toFixed(2)} s`;
  if (runs.some(({ failed }) => failed)) element("status").textContent = "a motion is no longer finite: choose a smaller step";
  const [first] = runs;
  Object.assign(document.documentElement.dataset, { time: clock.time, playing: clock.playing, frames: Number(document.documentElement.dataset.frames ?? 0) + 1, state: [...first.motions[0].values] });
}

/** The energy errors of the last seconds, on a logarithmic scale. */
function drawEnergy() {
  const { context, width, height } = clearedCanvas(element("energy-chart").firstElementChild);
  const [left, right, top, bottom] = [CHART.left, width - CHART.right, CHART.top, height - CHART.bottom];
  const end = Math.max(clock.time, CHART_SECONDS);
  const [low, high] = [-16, 2];
  const xAt = (time) => right - ((end - time) / CHART_SECONDS) * (right - left);
  const yAt = (exponent) => bottom - ((Math.min(Math.max(exponent, low), high) - low) / (high - low)) * (bottom - top);
  const rows = ticks(low, high, 6).map(({ value }) => [yAt(value), powerOfTen(value)]);
  const columns = ticks(end - CHART_SECONDS, end, 2).map(({ value, text }) => [xAt(value), text]);
  drawGrid(context, { left, right, top, bottom }, columns, rows, "time / s");
  runs.forEach(({ track }, number) => {
    context.strokeStyle = colour(trackColour(number));
    context.lineWidth = 1.75;
    context.beginPath();
    for (let k = sampleAt(track.t, end - CHART_SECONDS); k < track.t.length; k += 1) {
      const size = Math.abs(track.energy_error[k]);
      if (size > 0) context.lineTo(Math.max(xAt(track.t[k]), left), yAt(Math.log10(size)));
    }
    context.stroke();
    const error = scientific(Math.abs(track.energy_error.at(-1)));
    element("legend").children[number].lastChild.textContent = `${track.label}: ${error} J`;
  });
}

function setPlaying(playing) {
  clock.playing = playing;
  clock.lastFrame = null;
  element("play").textContent = playing ? "Pause" : "Play";
  redraw();
}

function addSettings() {
  [...system.coordinates, ...system.coordinates].forEach(({ label, unit }, k) => {
    const input = document.createElement("input");
    Object.assign(input, { type: "number", step: "any" });
    input.addEventListener("change", () => {
      if (Number.isFinite(input.valueAsNumber)) start[k] = input.valueAsNumber;
      restart();
    });
    field(element("start"), k < count ? `${label} in ${unit}` : `rate of ${label} in ${unit}/s`, input);
  });
  system.parameters.forEach(({ name, unit, value, isPositive, meaning }, k) => {
    const input = document.createElement("input");
    const size = Math.abs(value) || 1;
    const range = isPositive ? [size / 20, 4 * size] : [-2 * size, 2 * size];
    Object.assign(input, { type: "range", step: "any", min: range[0], max: range[1], value: parameters[k], title: meaning });
    input.addEventListener("input", () => {
      parameters[k] = Number(input.valueAsNumber.toPrecision(3));
      restart();
    });
    field(element("parameters"), name, input, () => `${parameters[k]} ${unit}`);
  });
}

function addListeners() {
  element("play").addEventListener("click", () => setPlaying(!clock.playing));
  element("restart").addEventListener("click", restart);
  element("copies").addEventListener("input", restart);
  element("compare").addEventListener("change", (event) => {
    const methods = runs.map(({ name, h }) => [name, h]);
    build(event.target.checked ? [methods[0], ["rk1", methods[0][1]]] : methods.slice(0, 1));
  });
  document.addEventListener("keydown", (event) => {
    if (event.target.matches("select, input") || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " " && !event.target.matches("button")) setPlaying(!clock.playing);
    else if (event.key === "r") restart();
    else return;
    event.preventDefault();
  });
  document.addEventListener("visibilitychange", () => {
    clock.lastFrame = null;
  });
  new ResizeObserver(redraw).observe(element("player"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

const initial = initialSettings();
element("copies").value = String(initial.copies);
element("compare").checked = initial.runs.length > 1;
addSettings();
build(initial.runs);
addListeners();
setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
