// The view of motions in space: parallel projection along a direction that the reader turns.

/** Angles of the direction of view in rad, of all panels. */
const camera = { azimuth: 0.5, elevation: 0.45 };
/** Turn of an arrow key in rad, and of a drag in rad per pixel. */
const KEY_TURN = 0.1;
const DRAG_TURN = 0.01;

/** The components [right, up] on the plane of view in m; of a position in the plane itself. */
function flattened(position) {
  if (position.length === 2) return position;
  const [x, y, z] = position;
  const { azimuth, elevation } = camera;
  const right = Math.cos(azimuth) * x + Math.sin(azimuth) * y;
  return [right, Math.cos(elevation) * z + Math.sin(elevation) * away([x, y])];
}

/** The horizontal distance from the reader, up to a constant. */
function away([x, y]) {
  return Math.cos(camera.azimuth) * y - Math.sin(camera.azimuth) * x;
}

/** The distance from the reader, up to a constant. */
function depth(position) {
  if (position.length === 2) return 0;
  return Math.cos(camera.elevation) * away(position) - Math.sin(camera.elevation) * position[2];
}

function turn(right, up) {
  camera.azimuth += right;
  camera.elevation = Math.min(Math.max(camera.elevation + up, -Math.PI / 2), Math.PI / 2);
  redraw();
}

/** Let a pointer that drags a canvas, and the arrow keys while it has the focus, turn the view. */
function addTurning(canvas) {
  canvas.tabIndex = 0;
  canvas.classList.add("turning");
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    turn(-DRAG_TURN * event.movementX, DRAG_TURN * event.movementY);
  });
  const turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  canvas.addEventListener("keydown", (event) => {
    if (!(event.key in turns) || event.ctrlKey || event.metaKey || event.altKey) return;
    turn(...turns[event.key].map((sign) => sign * KEY_TURN));
    event.preventDefault();
    event.stopPropagation(); // elsewhere these keys change the time
  });
}
