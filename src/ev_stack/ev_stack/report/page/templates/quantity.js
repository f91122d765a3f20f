"use strict";
// One quantity of one or two runs, with its heading and its plots.

/** Curves of a plot for a run.

    A page with several runs has one stroke for each, as figures have, which a plot of one channel takes. Several
    channels of one run have strokes by their places; `over` another run they keep their dashes, in the colour of the run. */
function curvesOf(plot, run, over) {
  return plot.curves
    .map(({ channel, label }, n) => {
      const byPlace = STROKES[n % STROKES.length];
      const own = run.stroke && plot.curves.length === 1 ? run.stroke : byPlace;
      const name = over ? `${label} ${nameOf(run)}`.trim() : label;
      return { run, channel, label: name, stroke: over ? [colourOver(run, over), own[1]] : own };
    })
    .filter(({ channel }) => run.channels[channel]);
}

/** Curves of one run less another, which are those of neither. */
function differencesOf(plot, run, minus) {
  const curves = curvesOf(plot, run).filter(({ channel }) => minus.channels[channel]);
  return curves.map((curve, n) => ({ ...curve, stroke: STROKES[n % STROKES.length] }));
}

/** The colour of a run beside another one: with very many runs two may share theirs. */
function colourOver(run, other) {
  const shared = run.stroke[0] === other.stroke[0] && INDEX.runs.indexOf(run) > INDEX.runs.indexOf(other);
  return shared ? "#000000" : run.stroke[0];
}

function plotInto(holder, title, curves, minus, siblings, kind = "plot") {
  const box = element("div", "", { class: kind });
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
    plotInto(box, plot.title, [...curvesOf(plot, first, second), ...curvesOf(plot, second, first)], null, siblings);
  } else if (second && how === "difference") {
    plotInto(box, plot.title, differencesOf(plot, first, second), second, siblings);
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
