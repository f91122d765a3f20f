"use strict";
// Words of the page: legends that can be used by keyboard, headings of plots, what is constant.

/** Let Enter and the space bar do in a legend what a click does. */
function nameLegend(chart) {
  for (const entry of chart.root.querySelectorAll(".u-series:not(:first-child) th")) {
    entry.tabIndex = 0;
    entry.setAttribute("role", "button");
    entry.title = "hide or show";
    entry.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      entry.click();
    });
  }
}

/** The name of a run in words. */
function nameOf(run) {
  return run.name.replaceAll("_", " ") + (run.spun ? " (spun)" : "");
}

/** A new element with text and attributes. */
function element(tag, text = "", attributes = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

/** Heading of a plot: quantity, unit, and what it means in smaller letters. */
function headingOf(plot) {
  const heading = element("h4", plot.unit ? `${plot.title} [${plot.unit}]` : plot.title);
  if (plot.about) heading.append(" ", element("small", plot.about));
  return heading;
}

/** Whether a channel never changes in any of the runs that have it. */
function isConstant(runs, channel) {
  return runs.every((run) => !run.channels[channel] || run.channels[channel].step === 0);
}

/** The value of a channel that never changes, in each run that has it. */
function constantText(runs, plot) {
  const values = plot.curves.map(({ channel, label }) => {
    const found = runs.filter((run) => run.channels[channel]).map((run) => digits(run.channels[channel].low));
    return `${label} ${[...new Set(found)].join(" and ")}`.trim();
  });
  return `${plot.title} ${values.join(", ")}${plot.unit && plot.unit !== "1" ? ` ${plot.unit}` : ""}`;
}
