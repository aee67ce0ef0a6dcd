// The clock and what moves it: the button, the bar, the chart and the keyboard.

/** What an arrow key steps by, in s. */
const STEP = 0.02;

const part = (name) => document.getElementById(name);
const [play, scrub, speed] = ["play", "scrub", "speed"].map(part);
const box = reach();
const panels = tracks.map((track, number) => new Panel(track, number, box));
const strip = new Strip(part("strip"));
const errors = tracks.map((track, number) => legendEntry(track.label, number));
const clock = { time: begin, playing: false, lastFrame: null };
let frameIsDue = false;

function legendEntry(label, number) {
  const value = document.createElement("span");
  value.className = "number";
  const entry = document.createElement("li");
  entry.append(swatch(number), `${label}: `, value);
  part("legend").append(entry);
  return value;
}

/** Ask for one frame, however many changes there are before it. */
function redraw() {
  if (frameIsDue) return;
  frameIsDue = true;
  requestAnimationFrame(frame);
}

function frame(now) {
  frameIsDue = false;
  if (clock.playing) {
    // real time: what passed since the last frame, whatever the frame rate
    if (clock.lastFrame !== null) {
      clock.time += (Number(speed.value) * (now - clock.lastFrame)) / 1000;
    }
    clock.lastFrame = now;
    if (clock.time >= end) {
      clock.time = end;
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
  strip.moveCursor(time);
  scrub.value = String(time);
  const text = `${time.toFixed(3).replace("-", "−")} s`;
  part("time").textContent = `${text} of ${Number(end.toPrecision(6))} s`;
  // spoken at rest only: it would never end otherwise
  if (!clock.playing) scrub.setAttribute("aria-valuetext", text);
  tracks.forEach((track, number) => {
    errors[number].textContent = scientific(Math.abs(valueAt(track.t, track.energy_error, time)));
  });
  part("apart").textContent = apartText(time);
  Object.assign(document.documentElement.dataset, { time, playing: clock.playing });
}

function apartText(time) {
  if (tracks.some((track) => hasEnded(track, time))) return "a run has ended";
  const distance = fixed(distanceApart(time), 5e-5 * Math.max(box.width, box.height));
  return `last masses ${tracks.length > 2 ? "up to " : ""}${distance} m apart`;
}

function setPlaying(playing) {
  clock.playing = playing;
  clock.lastFrame = null;
  play.textContent = playing ? "Pause" : "Play";
  redraw();
}

function togglePlaying() {
  if (!clock.playing && clock.time >= end) clock.time = begin;
  setPlaying(!clock.playing);
}

/** Go to a time and stay there: whoever chooses a moment wants to look at it. */
function seek(time) {
  clock.time = Math.min(Math.max(time, begin), end);
  setPlaying(false);
}

function isInSight(element) {
  const { top, bottom } = element.getBoundingClientRect();
  return top < window.innerHeight && bottom > 0;
}

function listen() {
  play.addEventListener("click", togglePlaying);
  scrub.addEventListener("input", () => seek(Number(scrub.value)));
  const follow = (event) => seek(strip.timeAt(event.offsetX));
  strip.canvas.addEventListener("pointerdown", (event) => {
    // captured: the drag goes on when the pointer leaves the chart
    strip.canvas.setPointerCapture(event.pointerId);
    follow(event);
  });
  strip.canvas.addEventListener("pointermove", (event) => {
    if (strip.canvas.hasPointerCapture(event.pointerId)) follow(event);
  });
  document.addEventListener("keydown", (event) => {
    // a list of choices has its own keys, and so have the browser's shortcuts
    if (event.target.matches("select") || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!isInSight(part("player"))) return; // on a long page the keys scroll
    // a button that has the focus is clicked by the space bar anyway
    if (event.key === " " && !event.target.matches("button")) togglePlaying();
    else if (event.key === "ArrowLeft") seek(clock.time - STEP);
    else if (event.key === "ArrowRight") seek(clock.time + STEP);
    else return;
    event.preventDefault();
  });
  // a hidden page gets no frames: the motion waits, instead of leaping when it is seen again
  document.addEventListener("visibilitychange", () => {
    clock.lastFrame = null;
  });
  const redrawAll = () => {
    strip.draw();
    redraw();
  };
  const observer = new ResizeObserver(redrawAll);
  for (const { canvas } of [...panels, strip]) observer.observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawAll);
}

part("panels").append(...panels.map((panel) => panel.figure));
part("apart").hidden = tracks.length < 2;
part("trail").textContent = String(TRAIL);
scrub.min = String(begin);
scrub.max = String(end);
listen();
strip.draw();
setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
