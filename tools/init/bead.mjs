// A model in JavaScript, for node: a bead between two wells, pulled by a spring. Put your own in place of Bead.
//
// The bead slides on a rail along x and rests in one of two wells. The HIP pulls it by a spring that weakens with the
// HIP's distance from the rail. The state s is the bead's place, in mm. With the HIP at (x, y, z) and q = y^2 + z^2,
//
//   E = b/4 (s^2 - a^2)^2 + k(q)/2 (x - s)^2      k(q) = k0 / (1 + q/R^2)
//   dE/ds = 0:  s^3 + P s - Q = 0                 P = k/b - a^2,  Q = k/b x
//
// There are two stable roots, one on each side of 0, or a single one. So the bead remembers
// only its side: the sign of s.
// PROTOCOL.md of hapgrid describes the lines that go back and forth. Only they may go to standard output; messages go
// through console.error().
import { createInterface } from 'node:readline';

// The parameters of the definition, with their defaults.
const defaults = { wells: 10, depth: 5, stiffness: 0.25, reach: 10, strength: 60, tolerance: 1e-6 };

class Bead {
  constructor(given) {
    for (const key of Object.keys(given)) {
      if (!(key in defaults)) throw new Error(`unknown parameter ${key} (known: ${Object.keys(defaults).join(', ')})`);
      if (!(given[key] > 0)) throw new Error(`parameter ${key} is ${given[key]}, it must be positive`);
    }
    Object.assign(this, defaults, given);
    this.b = (4 * this.depth) / this.wells ** 4;
    const well = { radius: this.wells / 20, colour: [0.4, 0.4, 0.9] };
    // force, energy and shape are kept in the grid, so that play does not need this program.
    this.description = {
      state_size: 1, d_max: this.reach, tolerance: this.tolerance, tolerance_unit: 'mm',
      length_unit: 'mm', energy_unit: 'N mm', force_scale: 1, stored: ['force', 'energy', 'shape'],
      spheres: [{ radius: this.wells / 5, colour: [0.9, 0.9, 0.3] }, well, well],
    };
  }

  spring(x) {
    return this.stiffness / (1 + (x[1] * x[1] + x[2] * x[2]) / (this.reach * this.reach));
  }

  // The bead's place with the HIP at x when it comes from that side. Your equations go here.
  settle(x, right) {
    const k = this.spring(x) / this.b;
    const p = (k - this.wells * this.wells) / 3, q = (k * x[0]) / 2; // a third of P, half of Q
    const d = q * q + p * p * p;
    if (d < 0) { // two stable roots
      const root = 2 * Math.sqrt(-p) * Math.cos(Math.acos((right ? q : -q) / Math.sqrt(-p * p * p)) / 3);
      return right ? root : -root;
    }
    const u = Math.cbrt(Math.abs(q) + Math.sqrt(d)); // Cardano's formula u - p/u, written so that nothing cancels
    return u > 0 ? (2 * q) / (u * u + p + (p / u) * (p / u)) : 0;
  }

  // What the search starts from, in the corners of the box: a state for each side, or a single one.
  known_states({ x }) {
    const left = this.settle(x, false), right = this.settle(x, true);
    return { states: left < 0 && right > 0 ? [[left], [right]] : [[left]] };
  }

  // C(s, x, d): the HIP walks from x to x + d in steps that are short against the reach of the spring.
  convert({ s, x, d }) {
    const steps = Math.ceil(Math.hypot(...d) / (this.reach / 64));
    let place = s[0];
    for (let step = 1; step <= steps; ++step) {
      const hip = x.map((a, i) => a + (step / steps) * d[i]);
      place = this.settle(hip, place >= 0);
      if (Math.hypot(hip[0] - place, hip[1], hip[2]) > this.strength)
        throw new Error(`the spring broke: it is longer than ${this.strength} mm`);
    }
    return { s: [place], ...this.evaluate({ s: [place], x: x.map((a, i) => a + d[i]) }) };
  }

  // What is stored with the state s, for the HIP at x. The force is -dE/dx, in newtons.
  evaluate({ s, x }) {
    const k = this.spring(x), u = x[0] - s[0], well = s[0] * s[0] - this.wells * this.wells;
    const sideways = (u * u * k * k) / (this.stiffness * this.reach * this.reach); // -k'(q) u^2
    return {
      force: [-k * u, sideways * x[1], sideways * x[2]],
      energy: (this.b / 4) * well * well + (k / 2) * u * u,
      shape: [s[0], 0, 0, -this.wells, 0, 0, this.wells, 0, 0],
    };
  }
}

// The first line has the parameters, each further line is a question for the method of its name.
let model;
const say = (answer) => process.stdout.write(JSON.stringify(answer) + '\n');
for await (const line of createInterface({ input: process.stdin })) {
  const question = JSON.parse(line);
  try {
    if (model) say({ id: question.id, ...model[question.op](question) });
    else say({ hapgrid: 1, ...(model = new Bead(question.parameters)).description });
  } catch (e) {
    say({ id: question.id, error: e.message });
    if (!model) break;
  }
}
