"use strict";
// The curves of the manoeuvre beside the car: all runs over each other, with one legend for all plots.

/** Curves of a plot: of one run in the strokes of their places, of several each in the colour of its run. */
function curvesOfAll(plot) {
  const factor = plot.factor;
  const [only, ...others] = INDEX.runs;
  if (!others.length) return curvesOf(plot, only).map((curve) => ({ ...curve, factor }));
  return INDEX.runs.flatMap((run) => {
    const dashes = plot.curves.length > 1 ? null : run.stroke[1];
    return plot.curves
      .map(({ channel, label }, n) => ({ run, channel, label, factor, stroke: [run.stroke[0], dashes ?? STROKES[n % STROKES.length][1]] }))
      .filter(({ channel }) => run.channels[channel]);
  });
}

/** Show the curves that the scenario names. */
function showCurves() {
  const holder = document.getElementById("first-plots");
  const shown = INDEX.curves.map((plot) => {
    const box = element("div", "", { class: "first" });
    box.append(element("h3", plot.unit ? `${plot.title} [${plot.unit}]` : plot.title, { title: plot.about }));
    plotInto(box, plot.title, curvesOfAll(plot), null, [], "plot small");
    return box;
  });
  holder.replaceChildren(...shown);
  showLegend();
}

/** Name the strokes of all plots once: runs by their colours, channels of one quantity by their dashes. */
function showLegend() {
  const several = INDEX.runs.length > 1;
  const entries = several ? INDEX.runs.map((run) => [nameOf(run), run.stroke]) : [];
  const longest = INDEX.curves.reduce((found, plot) => (plot.curves.length > found.length ? plot.curves : found), []);
  if (longest.length > 1) {
    longest.forEach(({ label }, n) => {
      const [colour, dashes] = STROKES[n % STROKES.length];
      entries.push([label, [several ? "#4a5560" : colour, dashes]]);
    });
  }
  document.getElementById("legend").replaceChildren(...entries.map(([name, stroke]) => {
    const entry = element("li");
    entry.append(sampleOf(stroke), ` ${name}`);
    return entry;
  }));
}

/** A short line in a stroke. */
function sampleOf([colour, dashes]) {
  const space = "http://www.w3.org/2000/svg";
  const picture = document.createElementNS(space, "svg");
  const line = document.createElementNS(space, "line");
  for (const [name, value] of Object.entries({ width: 26, height: 8, "aria-hidden": "true" })) picture.setAttribute(name, value);
  const drawn = { x1: 0, x2: 26, y1: 4, y2: 4, stroke: colour, "stroke-width": 2, "stroke-dasharray": DASHES[dashes].join(" ") };
  for (const [name, value] of Object.entries(drawn)) line.setAttribute(name, value);
  picture.append(line);
  return picture;
}
