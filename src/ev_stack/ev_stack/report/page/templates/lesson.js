"use strict";
// What stands beside each other: sliders of the parameters that the scenario names, plots, and whether it is over.

const BESIDE = [["Speed", "twist.longitudinal"], ["Yaw rate", "imu.yaw_rate"], ["Drive torques", "wheel_states.effort.front_left"]];
let times = null; // {over, end, period}: when the manoeuvre is over and when the run ends [s]

/** Show the sliders that the plant of the graph names, and keep its times. */
function showLesson(request) {
  const plant = nodes.get("plant");
  if (!plant) return byId("lesson").replaceChildren();
  const value = (name) => plant.get(name)?.value;
  times = { over: value("manoeuvre_end"), end: value("duration"), period: value("control_period") };
  const named = value("lesson") ?? [];
  byId("lesson").replaceChildren(...named.map((name) => {
    const [node, ...rest] = name.split(".");
    const parameter = nodes.get(node)?.get(rest.join("."));
    return parameter
      ? rowOf(node, parameter, `${node.replaceAll("_", " ")}: ${parameter.name}`, request)
      : element("p", `${name}: not in this run`, { class: "about" });
  }));
  if (!named.length) byId("lesson").append(element("p", "The scenario names no parameters for a lesson.", { class: "about" }));
}

/** Show the plots whose first channels these are, as far as they are there. */
function showBeside() {
  const plotted = live.groups.flatMap((group) => group.plots);
  byId("beside").replaceChildren(...BESIDE.flatMap(([title, channel]) => {
    const plot = plotted.find(({ curves }) => curves[0].channel === channel);
    return plot ? [quantity({ ...plot, title, about: "" }, { first: live.run, second: null })] : [];
  }));
}

/** In words that the manoeuvre is over at this time [s]; empty before that, and where its end is not known. `then` is what goes
 * on where the run is longer. */
function overAt(time, then = "") {
  if (!times?.over || !(time > times.over - times.period)) return "";
  const longer = !times.end || times.end > times.over + times.period;
  return `The manoeuvre is over since ${digits(times.over)} s${longer && then ? `; ${then}` : ""}.`;
}
