// The clock and its controls: the button, the slider, the chart and the keyboard.

/** Step of an arrow key in s, at the speed 1. */
const KEY_STEP = 0.02;

const element = (name) => document.getElementById(name);
const [playButton, slider, speed, follow] = ["play", "time-slider", "speed", "follow"].map(element);
const [box, largest] = [boundingBox(), largestConfiguration()];
const canFollow = goesFar(box, largest);
const panels = tracks.map((track, number) => new Panel(track, number, box, (time) => boxOf(track, time)));
const energyChart = new EnergyChart(element("energy-chart"));
const errors = tracks.map((track, number) => legendEntry(track.label, number));
const { coordinates } = tracks[0];
const overTime = new StateChart(element("over-time"), (track, number) => [track.t, track.coordinates[number][2]]);
const phasePlane = new StateChart(element("phase-plane"), (track, number) => track.coordinates[number].slice(2));
const stateCharts = coordinates.length > 0 ? [overTime, phasePlane] : [];
const clock = { time: startTime, playing: false, lastFrame: null };
const decimals = Math.max(3, 3 - Math.floor(Math.log10(endTime - startTime || 1)));

function legendEntry(label, number) {
  const value = document.createElement("span");
  value.className = "number";
  const entry = document.createElement("li");
  entry.append(swatch(number), `${label}: `, value);
  element("legend").append(entry);
  return value;
}

/** The box that a run's panel shows at a time. */
function boxOf(track, time) {
  return canFollow && follow.checked ? boxAround(track, time, largest, box) : box;
}

function frame(now) {
  if (clock.playing) {
    // real time: the time since the last frame, whatever the frame rate
    if (clock.lastFrame !== null) {
      clock.time += (Number(speed.value) * (now - clock.lastFrame)) / 1000;
    }
    clock.lastFrame = now;
    if (clock.time >= endTime) {
      clock.time = endTime;
      setPlaying(false);
    } else {
      redraw();
    }
  }
  show();
}

function show() {
  const { time } = clock;
  for (const panel of panels) panel.draw(time);
  energyChart.moveCursor(time);
  for (const chart of stateCharts) chart.moveDots(time);
  slider.value = String(time);
  const text = `${time.toFixed(decimals).replace("-", "−")} s`;
  element("time").textContent = `${text} of ${Number(endTime.toPrecision(6))} s`;
  // screen readers announce it only when paused
  if (!clock.playing) slider.setAttribute("aria-valuetext", text);
  tracks.forEach((track, number) => {
    if (track.energy_error === null) return;
    errors[number].textContent = scientific(Math.abs(valueAt(track.t, track.energy_error, time)));
  });
  element("distance").textContent = distanceText(time);
  Object.assign(document.documentElement.dataset, { time, playing: clock.playing, ...camera });
}

function showCoordinate(number) {
  const [label, unit] = coordinates[number];
  const [value, rate] = [inUnit(label, unit), inUnit(rateOf(label), `${unit}/s`)];
  overTime.show(number, ["time / s", value], `${label} over time`);
  phasePlane.show(number, [value, rate], `Rate of change of ${label} over ${label}`);
}

function distanceText(time) {
  if (tracks.some((track) => hasEnded(track, time))) return "a run has ended";
  const distance = withDecimals(largestDistance(time), 5e-5 * Math.max(box.width, box.height));
  return `last masses ${tracks.length > 2 ? "up to " : ""}${distance} m apart`;
}

function setPlaying(playing) {
  clock.playing = playing;
  clock.lastFrame = null;
  playButton.textContent = playing ? "Pause" : "Play";
  redraw();
}

function togglePlaying() {
  if (!clock.playing && clock.time >= endTime) clock.time = startTime;
  setPlaying(!clock.playing);
}

/** Select the highest speed up to 1 at which the motion lasts a second. */
function selectSpeed() {
  const slow = [...speed.options].filter(({ value }) => Number(value) <= Math.min(1, endTime - startTime));
  (slow.at(-1) ?? speed.options[0]).selected = true;
}

/** Go to a time and pause there. */
function seek(time) {
  clock.time = Math.min(Math.max(time, startTime), endTime);
  setPlaying(false);
}

function isVisible(node) {
  const { top, bottom } = node.getBoundingClientRect();
  return top < window.innerHeight && bottom > 0;
}

function addListeners() {
  playButton.addEventListener("click", togglePlaying);
  slider.addEventListener("input", () => seek(Number(slider.value)));
  follow.addEventListener("change", redraw);
  const seekToPointer = (event) => seek(energyChart.timeAt(event.offsetX));
  energyChart.canvas.addEventListener("pointerdown", (event) => {
    // captured, so that the drag continues outside the chart
    energyChart.canvas.setPointerCapture(event.pointerId);
    seekToPointer(event);
  });
  energyChart.canvas.addEventListener("pointermove", (event) => {
    if (energyChart.canvas.hasPointerCapture(event.pointerId)) seekToPointer(event);
  });
  document.addEventListener("keydown", (event) => {
    // a list of options and the shortcuts of the browser have keys of their own
    if (event.target.matches("select") || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!isVisible(element("player"))) return; // on a long page these keys scroll
    // the space bar clicks a focused button or box anyway
    if (event.key === " " && !event.target.matches("button, #follow")) togglePlaying();
    else if (event.key === "ArrowLeft") seek(clock.time - KEY_STEP * Number(speed.value));
    else if (event.key === "ArrowRight") seek(clock.time + KEY_STEP * Number(speed.value));
    else return;
    event.preventDefault();
  });
  // a hidden page has no frames: the motion waits, instead of jumping when it is visible again
  document.addEventListener("visibilitychange", () => {
    clock.lastFrame = null;
  });
  const redrawAll = () => {
    energyChart.draw();
    for (const chart of stateCharts) chart.draw();
    redraw();
  };
  element("coordinate").addEventListener("change", (event) => {
    showCoordinate(event.target.selectedIndex);
    redrawAll();
  });
  const observer = new ResizeObserver(redrawAll);
  for (const { canvas } of [...panels, energyChart, ...stateCharts]) observer.observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawAll);
}

element("panels").append(...panels.map((panel) => panel.figure));
follow.parentElement.hidden = !canFollow;
element("turning").hidden = !panels[0].isInSpace;
element("distance").hidden = tracks.length < 2;
element("energy").hidden = tracks.every((track) => track.energy_error === null);
element("trace-seconds").textContent = String(TRACE_SECONDS);
slider.min = String(startTime);
slider.max = String(endTime);
element("state").hidden = coordinates.length === 0;
element("coordinate").append(...coordinates.map(([label]) => new Option(label)));
if (coordinates.length > 0) showCoordinate(0);
addListeners();
selectSpeed();
energyChart.draw();
for (const chart of stateCharts) chart.draw();
setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
