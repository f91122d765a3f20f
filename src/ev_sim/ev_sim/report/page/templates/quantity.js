"use strict";
// One quantity of one or two runs, with its heading and its plots.

/** Curves of a plot for a run, in the strokes of their places; `over` is drawn dashed over another run. */
function curvesOf(plot, run, over, named) {
  return plot.curves
    .map(({ channel, label }, n) => {
      const [colour, dash] = STROKES[n % STROKES.length];
      const name = named ? `${label} ${nameOf(run)}`.trim() : label;
      return { run, channel, label: name, stroke: [colour, over == null ? dash : over ? [6, 4] : []] };
    })
    .filter(({ channel }) => run.channels[channel]);
}

function plotInto(holder, title, curves, minus, siblings) {
  const box = element("div", "", { class: "plot" });
  holder.append(box);
  if (!curves.length) {
    box.textContent = "not recorded in this run";
    return;
  }
  const plot = new Plot(box, title, curves, minus, siblings);
  siblings.push(plot);
  plots.set(box, plot);
  sight.observe(box);
  widths.observe(box);
}

/** One quantity as the runs were chosen to be shown. */
function quantity(plot, { first, second, how }) {
  const box = element("div", "", { class: "quantity" });
  box.append(headingOf(plot));
  const siblings = [];
  if (second && how === "over") {
    plotInto(box, plot.title, [...curvesOf(plot, first, false, true), ...curvesOf(plot, second, true, true)], null, siblings);
  } else if (second && how === "difference") {
    plotInto(box, plot.title, curvesOf(plot, first).filter(({ channel }) => second.channels[channel]), second, siblings);
  } else {
    const row = element("div", "", { class: second ? "plots beside" : "" });
    for (const run of second ? [first, second] : [first]) {
      const cell = element("div");
      if (second) cell.append(element("div", nameOf(run), { class: "run" }));
      plotInto(cell, plot.title, curvesOf(plot, run), null, siblings);
      row.append(cell);
    }
    box.append(row);
  }
  return box;
}
