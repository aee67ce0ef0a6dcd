// Runs that the page integrates. Before this script stand the generated functions of the system.

const system = JSON.parse(document.getElementById("system").textContent);
/** Largest number of samples of a second of a trace, of seconds that are kept, and of steps in a frame. */
const SAMPLE_RATE = 120;
const KEPT_SECONDS = 20;
const MOST_STEPS = 40000;
/** Displacement between the starts of neighbouring motions of a run, in units of the coordinates. */
const SPREAD = 1e-3;

const parameters = Float64Array.from(system.parameters, ({ value }) => value);
const start = Float64Array.from(system.start);
const count = system.coordinates.length;

/** The state in the form of the generated functions, of coordinates and velocities. */
function stateOf(values) {
  const places = system.coordinates.flatMap(({ isAngle }, k) =>
    isAngle ? [Math.sin(values[k]), Math.cos(values[k])] : [values[k]],
  );
  return Float64Array.from([...places, ...values.slice(count)]);
}

/** One motion: its state, and its angles over whole turns. */
class Motion {
  constructor(values) {
    this.y = stateOf(values);
    this.next = new Float64Array(this.y.length);
    this.angles = Float64Array.from([...values].filter((_, k) => system.coordinates[k]?.isAngle));
    this.values = new Float64Array(2 * count + 1);
    if (system.hasConstraints) for (let k = 0; k < 5; k += 1) project(0, this.y, parameters);
    this.observe(0);
  }

  /** A step of size h; the state stays where it is no longer finite. */
  step(t, h, derivatives) {
    step(t, h, this.y, parameters, derivatives, this.next);
    if (!this.next.every(Number.isFinite)) return false;
    this.y.set(this.next);
    if (this.angles.length > 0) follow(this.y, this.angles);
    return true;
  }

  /** Coordinates, velocities and energy. */
  observe(t) {
    row(t, this.y, this.angles, parameters, this.values);
    return this.values;
  }

  /** Positions of the masses, or the points of the links, in m. */
  places(compute, number, t) {
    const result = new Float64Array(number * system.dimension);
    if (number > 0) compute(t, this.values, parameters, result);
    return Array.from({ length: number }, (_, k) => [...result.slice(k * system.dimension, (k + 1) * system.dimension)]);
  }

  masses(t) {
    return this.places(positions, system.masses, t);
  }

  points(t) {
    return this.places(points, system.points, t);
  }
}

/** A method with a step size: a motion with its trace, and others that start beside it. */
class Run {
  constructor(name, h) {
    Object.assign(this, { name, h });
    const axes = (number) => Array.from({ length: number }, () => Array.from({ length: system.dimension }, () => []));
    const { links } = system;
    this.track = { label: "", t: [], positions: axes(system.masses), points: axes(system.points), links, energy_error: [] };
  }

  restart(copies) {
    const { track } = this;
    this.steps = 0;
    this.failed = false;
    this.motions = Array.from({ length: copies }, (_, k) => new Motion(start.map((x, n) => (n < count ? x + k * SPREAD : x))));
    this.energy = this.motions[0].values[2 * count];
    this.derivatives = new Float64Array(this.motions[0].y.length * system.methods[this.name].b.length);
    for (const list of [track.t, track.energy_error, ...track.positions.flat(), ...track.points.flat()]) list.length = 0;
    this.record();
  }

  get time() {
    return this.steps * this.h;
  }

  /** Take the steps up to a time; stop where a motion is no longer finite, or a frame would take too long. */
  advance(time) {
    useMethod(system.methods[this.name]);
    for (let k = 0; !this.failed && (this.steps + 1) * this.h <= time; k += 1) {
      if (k * this.motions.length > MOST_STEPS) return false;
      for (const motion of this.motions) {
        if (!motion.step(this.time, this.h, this.derivatives)) this.failed = true;
      }
      this.steps += 1;
      if (this.time - this.track.t.at(-1) >= 1 / SAMPLE_RATE - 1e-9) this.record();
    }
    if (this.time > this.track.t.at(-1)) this.record();
    this.motions.forEach((motion) => motion.observe(this.time));
    return true;
  }

  /** Append the state to the trace, and forget what is old. */
  record() {
    const { track, time } = this;
    const motion = this.motions[0];
    const error = motion.observe(time)[2 * count] - this.energy;
    track.t.push(time);
    track.energy_error.push(error);
    motion.masses(time).forEach((place, k) => place.forEach((x, axis) => track.positions[k][axis].push(x)));
    motion.points(time).forEach((place, k) => place.forEach((x, axis) => track.points[k][axis].push(x)));
    if (track.t.length < 2 * KEPT_SECONDS * SAMPLE_RATE) return;
    const old = track.t.length / 2;
    for (const list of [track.t, track.energy_error, ...track.positions.flat(), ...track.points.flat()]) list.splice(0, old);
  }
}

const runs = [];
const tracks = [];

/** Coordinates near those of a motion at which a mass is seen at a place, [right, up] in m, by least squares. */
function coordinatesAt(motion, mass, place) {
  const values = Float64Array.from(motion.values);
  const seen = (at) => {
    motion.values.set(at);
    return flattened(motion.masses(0)[mass]);
  };
  for (let sweep = 0; sweep < 20; sweep += 1) {
    const here = seen(values);
    const missing = [place[0] - here[0], place[1] - here[1]];
    const columns = Array.from({ length: count }, (_, k) => {
      const moved = Float64Array.from(values);
      moved[k] += 1e-6;
      return seen(moved).map((x, axis) => (x - here[axis]) / 1e-6);
    });
    // the smallest change of coordinates: J^T (J J^T + e)^-1 missing
    const product = (a, b) => columns.reduce((sum, column) => sum + column[a] * column[b], 0);
    const [xx, xy, yy] = [product(0, 0), product(0, 1), product(1, 1)];
    const damping = 1e-3 * (xx + yy) + 1e-12;
    const determinant = (xx + damping) * (yy + damping) - xy * xy;
    const weights = [
      ((yy + damping) * missing[0] - xy * missing[1]) / determinant,
      ((xx + damping) * missing[1] - xy * missing[0]) / determinant,
    ];
    columns.forEach((column, k) => {
      const change = column[0] * weights[0] + column[1] * weights[1];
      values[k] += Math.min(Math.max(change, -0.5), 0.5);
    });
  }
  return values.slice(0, count);
}
