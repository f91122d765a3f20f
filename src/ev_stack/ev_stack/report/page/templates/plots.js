"use strict";
// Time series, one plot for each quantity, drawn when it comes into sight.

const DASHES = { "-": [], "--": [8, 4], ":": [2, 3], "-.": [10, 4, 2, 4] };
const STROKES = [["#0072B2", "-"], ["#D55E00", "--"], ["#009E73", ":"], ["#A0508A", "-."]]; // of the channels of one run
const HEIGHT = 206;
const plots = new Map(); // holder -> Plot, of all that are on the page

class Plot {
  /** `curves`: {run, channel, label, stroke}; `minus` is the run of which the first is subtracted, if any. */
  constructor(holder, title, curves, minus, siblings) {
    const small = holder.classList.contains("small"); // of the first screen, with one legend for all
    Object.assign(this, { holder, title, curves, minus, siblings, small, chart: null, visible: false, asked: false });
  }

  async show() {
    this.visible = true;
    if (this.chart) this.followRange();
    if (this.asked) return;
    this.asked = true;
    await Promise.all(this.siblings.map((plot) => plot.load())); // they share an ordinate
    if (!this.chart) this.draw();
  }

  load() {
    this.loaded ??= Promise.all([
      Promise.all(this.curves.map((curve) => this.valuesOf(curve))),
      Promise.all(this.curves.map((curve) => instants(curve.run))),
    ]).then(([series, times]) => Object.assign(this, { series, times }));
    return this.loaded;
  }

  async valuesOf({ run, channel, factor = 1 }) {
    const values = await samples(run, channel);
    if (factor !== 1) return values.map((value) => (value == null ? null : factor * value));
    if (!this.minus) return values;
    const other = await samples(this.minus, channel);
    return difference(await instants(run), values, await instants(this.minus), other);
  }

  /** Draw for print what was never in sight, if its samples are there. */
  drawLoaded() {
    if (!this.chart && this.siblings.every((plot) => plot.series)) this.draw();
  }

  draw() {
    this.asked = true;
    const together = this.times.every((times) => sameTimes(times, this.times[0]));
    const data = together
      ? [this.times[0], ...this.series]
      : uPlot.join(this.series.map((values, n) => [this.times[n], values]));
    const width = this.holder.clientWidth;
    this.chart = new uPlot(optionsOf(this, width), data, this.holder);
    const canvas = this.chart.root.querySelector("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${this.title} over time, ${runsOf(this.curves)}`);
    obeyHand(this.chart);
    if (!this.small) nameLegend(this.chart);
    queueMicrotask(() => this.followTime()); // uPlot fixes its scales in a microtask of its own
  }

  /** Lowest and highest value between two instants, of this plot and of those that share its ordinate.

      Of runs in which the car has spun only if no others are shown: they would flatten these. */
  extent(begin, end) {
    let low = Infinity;
    let high = -Infinity;
    const isShown = (plot, n) => !plot.chart || plot.chart.series[n + 1].show;
    const allSpun = this.siblings.every((plot) => plot.curves.every(({ run }, n) => run.spun || !isShown(plot, n)));
    for (const plot of this.siblings) {
      (plot.series || []).forEach((values, n) => {
        if (!isShown(plot, n) || (plot.curves[n].run.spun && !allSpun)) return;
        const times = plot.times[n];
        const last = Math.min(indexAt(times, end) + 1, times.length - 1);
        for (let i = indexAt(times, begin); i <= last; i++) {
          if (values[i] == null) continue;
          if (values[i] < low) low = values[i];
          if (values[i] > high) high = values[i];
        }
      });
    }
    return [low, high];
  }

  followTime() {
    const [low, high] = clock.range;
    const seen = clock.now >= low && clock.now <= high;
    this.chart.setCursor(seen ? { left: this.chart.valToPos(clock.now, "x"), top: 1 } : { left: -10, top: -10 });
  }

  /** Draw what has come to the series, which are the ones that it has. */
  grow() {
    this.chart.setData([this.times[0], ...this.series], false);
  }

  followRange() {
    this.chart.setScale("x", { min: clock.range[0], max: clock.range[1] });
    queueMicrotask(() => this.followTime());
  }
}

function sameTimes(times, others) {
  const last = times.length - 1;
  return times === others || (times.length === others.length && times[0] === others[0] && times[last] === others[last]);
}

function optionsOf(plot, width) {
  return {
    width,
    height: heightOf(plot.holder),
    legend: { show: !plot.small },
    cursor: { drag: { x: true, y: false, setScale: false }, y: false, dataIdx: sampleNow, bind: { mouseleave: none, dblclick: none } },
    scales: {
      x: { time: false, min: clock.range[0], max: clock.range[1] },
      y: { range: (chart) => roomy(plot.extent(chart.scales.x.min ?? clock.begin, chart.scales.x.max ?? clock.end)) },
    },
    axes: plot.small ? smallAxes(width) : AXES,
    series: [
      { label: "time", value: (chart, value) => `${digits(value)} s` },
      ...plot.curves.map(({ label, stroke: [colour, dashes] }) => ({
        label: label || plot.title,
        stroke: colour,
        dash: DASHES[dashes],
        width: 1.3,
        points: { show: false },
        value: (chart, value) => digits(value),
      })),
    ],
    hooks: { setSelect: [(chart) => zoomTo(chart)] },
  };
}

const inDigits = (chart, ticks) => ticks.map(digits);
const AXES = [
  { size: 32, label: "time [s]", labelSize: 16, labelFont: "12px system-ui, sans-serif" },
  { size: 66, space: 24, values: inDigits },
];

/** Axes without labels, so that four plots fit beside a car; every instant has its unit. */
function smallAxes(width) {
  const font = `${width < 260 ? 10 : 12}px system-ui, sans-serif`;
  const inSeconds = (chart, ticks) => ticks.map((time) => `${digits(time)} s`);
  return [
    { size: 22, gap: 2, space: 44, ticks: { size: 4 }, font, values: inSeconds },
    { size: width < 260 ? 38 : 52, gap: 2, space: 20, ticks: { size: 4 }, font, values: inDigits },
  ];
}

/** Height of a plot [px]: on the first screen what the style gives it. */
function heightOf(holder) {
  return holder.classList.contains("small") ? holder.clientHeight : HEIGHT;
}

/** The names of the runs of some curves. */
function runsOf(curves) {
  return [...new Set(curves.map(({ run }) => nameOf(run)))].join(" and ");
}

const none = () => null;
const sampleNow = (chart) => indexAt(chart.data[0], clock.now); // not the one that is nearest to a pixel

/** Zoom all plots to what was dragged over in one. */
function zoomTo(chart) {
  const { left, width } = chart.select;
  if (width < 3) return;
  clock.zoom(chart.posToVal(left, "x"), chart.posToVal(left + width, "x"));
  chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}

/** Let the pointer over one plot set the instant of all; two clicks show all of the time. */
function obeyHand(chart) {
  chart.over.addEventListener("mousemove", (event) => {
    if (!clock.follows) clock.set(chart.posToVal(event.offsetX, "x"));
  });
  chart.over.addEventListener("dblclick", () => clock.all());
}

/** Limits in which a constant does not look like noise; as in figures/sheets.py. */
function roomy([low, high]) {
  if (low > high) return [0, 1];
  if (low === 0 && high === 0) return [-1, 1];
  const margin = Math.max(0.06 * (high - low), 1e-3 * Math.max(Math.abs(low), Math.abs(high)));
  return [low - margin, high + margin];
}

const sight = new IntersectionObserver((seen) => {
  for (const { target, isIntersecting } of seen) {
    const plot = plots.get(target);
    if (plot && isIntersecting) plot.show();
    else if (plot) plot.visible = false;
  }
}, { rootMargin: "200px" });

const widths = new ResizeObserver((changed) => {
  for (const { target } of changed) {
    const chart = plots.get(target)?.chart;
    if (chart && target.clientWidth) chart.setSize({ width: target.clientWidth, height: heightOf(target) });
  }
});

const drawn = () => [...plots.values()].filter((plot) => plot.chart && plot.visible);
clock.onTime.add(() => drawn().forEach((plot) => plot.followTime()));
clock.onRange.add(() => drawn().forEach((plot) => plot.followRange()));
