"use strict";
// The cars of the runs that are shown, side by side, at the instant of the clock, each with a table of its wheels.

const FORCES = ["tire_forces.longitudinal_force", "tire_forces.lateral_force"];
const COLUMNS = [
  // heading, channel before the name of the wheel, factor, decimals
  ["angle [deg]", "view.wheel_angle", 180 / Math.PI, 2],
  ["speed [rad/s]", "wheel_states.velocity", 1, 2],
  ["drive torque [N m]", "wheel_states.effort", 1, 1],
  ["slip ratio", "tire_forces.slip_ratio", 1, 4],
  ["along [N]", FORCES[0], 1, 0],
  ["across [N]", FORCES[1], 1, 0],
  ["load [N]", "tire_forces.load", 1, 0],
  ["friction", "tire_forces.friction_coefficient", 1, 2],
];
const TRAIL = 4000; // points of a path that are drawn
let views = [];

class CarView {
  constructor(run, holder) {
    Object.assign(this, { run, car: run.car, path: new Path2D(), bounds: [Infinity, -Infinity, Infinity, -Infinity], ready: false });
    const box = element("div", "", { class: "car" });
    this.title = element("h3", nameOf(run));
    this.canvas = element("canvas", "", { role: "img", "aria-label": `The car of ${nameOf(run)} from above` });
    this.wide = element("select", "", { "aria-label": `How much is seen of ${nameOf(run)}` });
    for (const [value, text] of [["6", "6 m"], ["20", "20 m"], ["80", "80 m"], ["0", "whole path"]])
      this.wide.append(element("option", text, { value }));
    this.wide.addEventListener("change", () => this.draw());
    const tools = element("div", "", { class: "tools" });
    this.where = element("span");
    this.columns = COLUMNS.filter(([, channel]) => run.channels[`${channel}.front_left`]);
    const wheels = element("details");
    // The numbers of a recorded run can wait, those of a running one are what is looked at.
    wheels.append(element("summary", "Place and wheels"), ...(clock.follows ? [] : [this.where]), this.table());
    tools.append(this.wide, " ", ...(clock.follows ? [this.where] : []));
    box.append(this.title, this.canvas, tools, wheels);
    holder.append(box);
  }

  table() {
    const scroll = element("div", "", { class: "scroll", tabindex: "0", role: "region", "aria-label": `Wheels of ${nameOf(this.run)}` });
    const table = element("table");
    const head = element("tr");
    for (const title of ["", ...this.car.wheels.map((wheel) => wheel.name)]) head.append(element("th", title, { scope: "col" }));
    table.append(head);
    this.cells = this.car.wheels.map(() => []); // by wheel and quantity
    for (const [title] of this.columns) {
      const row = element("tr");
      row.append(element("th", title, { scope: "row" }));
      for (const cells of this.cells) cells.push(row.appendChild(element("td")));
      table.append(row);
    }
    scroll.append(table);
    return scroll;
  }

  async load() {
    const at = (name) => samples(this.run, name);
    const ofWheels = (name) => Promise.all(this.car.wheels.map((wheel) => at(`${name}.${wheel.name.replace(" ", "_")}`)));
    this.times = await instants(this.run);
    [this.x, this.y, this.heading, this.speed, this.roll] = await Promise.all(
      ["pose.x", "pose.y", "view.heading", "twist.longitudinal", "view.roll"].map(at));
    this.values = await Promise.all(this.columns.map(([, channel]) => ofWheels(channel)));
    if (!this.x || !this.y || !this.heading) {
      this.where.textContent = "This run has no pose, so there is nothing to see from above.";
      return;
    }
    this.unit = this.forceOfAnArrow();
    this.trace();
    this.ready = true;
    this.draw();
  }

  /** Force of an arrow of 1 m [N]: 2/3 of a wheel's static load, or the largest drive force without tyre forces. */
  forceOfAnArrow() {
    const torques = this.values[this.columns.findIndex((column) => column[1] === "wheel_states.effort")];
    if (this.run.channels[`${FORCES[0]}.front_left`] || !torques) return this.car.load / 1.5;
    let largest = 0;
    for (const wheel of torques) for (const torque of wheel || []) largest = Math.max(largest, Math.abs(torque));
    return largest / this.car.radius || this.car.load;
  }

  trace() {
    const every = Math.max(1, Math.floor(this.x.length / TRAIL));
    for (let n = 0; n < this.x.length; n += every) this.pass(n);
  }

  /** Let the path go on to the place of a sample. */
  pass(n) {
    const [x, y] = [this.x[n], this.y[n]];
    if (x == null || y == null) return;
    this.path.lineTo(x, y);
    const [left, right, bottom, top] = this.bounds;
    this.bounds = [Math.min(left, x), Math.max(right, x), Math.min(bottom, y), Math.max(top, y)];
  }

  column(channel, n) {
    const found = this.columns.findIndex((column) => column[1] === channel);
    return this.car.wheels.map((wheel, w) => (found < 0 ? null : this.values[found][w]?.[n] ?? null));
  }

  draw() {
    if (!this.ready || !this.canvas.clientWidth) return;
    const n = indexAt(this.times, clock.now);
    const angles = this.column("view.wheel_angle", n);
    const friction = this.column("tire_forces.friction_coefficient", n);
    const hasForces = this.columns.some((column) => column[1] === FORCES[0]);
    const along = hasForces ? this.column(FORCES[0], n)
      : this.column("wheel_states.effort", n).map((torque) => (torque == null ? null : torque / this.car.radius));
    const across = this.column(FORCES[1], n);
    const wheels = angles.map((angle, w) => ({ angle, friction: friction[w], along: along[w], across: across[w] ?? 0 }));
    const roll = this.roll?.[n] ?? 0;
    const state = { x: this.x[n], y: this.y[n], heading: this.heading[n], roll, wheels };
    if (state.x == null || state.y == null || state.heading == null) return;
    drawCar(this.canvas, this, state, Number(this.wide.value));
    const speed = this.speed ? `, ${fixed(this.speed[n], 2)} m/s` : "";
    const leaning = this.roll ? `, roll ${fixed(roll * 180 / Math.PI, 2)} deg` : "";
    const instead = hasForces ? "" : "; this plant has no tyre forces, arrows are drive torque over wheel radius";
    const unit = `; an arrow of 1 m is ${this.unit.toFixed(0)} N${instead}`;
    const heading = Math.atan2(Math.sin(state.heading), Math.cos(state.heading)) * 180 / Math.PI;
    this.where.textContent = `x ${fixed(state.x, 2)} m, y ${fixed(state.y, 2)} m, heading ${fixed(heading, 1)} deg${leaning}${speed}${unit}`;
    this.columns.forEach(([, , factor, decimals], c) => this.cells.forEach((row, w) => {
      const value = this.values[c][w]?.[n];
      row[c].textContent = value == null ? "–" : fixed(value * factor, decimals);
    }));
  }
}

/** Show the cars of these runs. */
function showCars(runs) {
  const holder = document.getElementById("cars");
  holder.replaceChildren();
  const seen = document.querySelectorAll("#view, nav [href='#view']");
  for (const each of seen) each.hidden = !runs.some((run) => run.car);
  views = runs.filter((run) => run.car).map((run) => new CarView(run, holder));
  return Promise.all(views.map((view) => view.load()));
}

let waiting = false;
function redrawCars() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    views.forEach((view) => view.draw());
  });
}
clock.onTime.add(redrawCars);
window.addEventListener("resize", redrawCars);
