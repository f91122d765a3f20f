"use strict";
// Which runs are shown and how, and what the bar at the bottom does.

const bar = Object.fromEntries([...document.getElementById("bar").querySelectorAll("[id]")].map((each) => [each.id, each]));
const NONE = "-1";

function chosen() {
  const first = INDEX.runs[bar.first.value];
  const second = bar.second.value === NONE ? null : INDEX.runs[bar.second.value];
  return { first, second, how: second ? bar.how.value : "beside" };
}

function showGroups(choice) {
  sight.disconnect();
  widths.disconnect();
  for (const { chart } of plots.values()) chart?.destroy();
  plots.clear();
  const runs = [choice.first, choice.second].filter(Boolean);
  const shown = INDEX.groups.map((group) => {
    const section = element("section");
    section.append(element("h3", group.title), element("p", group.about, { class: "about" }));
    const grid = element("div", "", { class: choice.second && choice.how === "beside" ? "" : "plots" });
    const constant = [];
    for (const plot of group.plots) {
      if (plot.curves.every(({ channel }) => runs.every((run) => !run.channels[channel]))) continue;
      if (plot.curves.every(({ channel }) => isConstant(runs, channel))) constant.push(constantText(runs, plot));
      else grid.append(quantity(plot, choice));
    }
    section.append(grid);
    if (constant.length) section.append(element("p", `Constant: ${constant.join("; ")}.`, { class: "constant" }));
    return section;
  });
  document.getElementById("groups").replaceChildren(...shown);
}

async function show() {
  const choice = chosen();
  bar["how-label"].hidden = !choice.second;
  const runs = [choice.first, choice.second].filter(Boolean);
  const times = await Promise.all(runs.map(instants));
  clock.begin = Math.min(...times.map((time) => time[0]));
  clock.end = Math.max(...times.map((time) => time[time.length - 1]), clock.begin + 1e-3);
  clock.range = [clock.begin, clock.end];
  bar.time.max = times[0].length - 1;
  stepOf = (time) => indexAt(times[0], time);
  timeOf = (step) => times[0][step];
  showGroups(choice);
  showCurves();
  await showCars(runs);
  clock.set(clock.now);
  document.body.dataset.ready = "yes";
  for (const plot of [...plots.values()]) await plot.load(); // so that the page can be printed at any time
  document.body.dataset.loaded = "yes";
}

/** Let the page count as loaded, and a printer wait, until something is done: a document that is open is loading. */
async function loadingUntil(done) {
  const frame = element("iframe", "", { hidden: "" });
  document.body.append(frame);
  frame.contentDocument.open();
  await done;
  frame.contentDocument.close();
  frame.remove();
}

window.addEventListener("beforeprint", () => {
  for (const plot of plots.values()) plot.drawLoaded();
});

let stepOf = () => 0;
let timeOf = () => 0;

function fillRuns() {
  INDEX.runs.forEach((run, n) => {
    bar.first.append(element("option", nameOf(run), { value: n }));
    bar.second.append(element("option", nameOf(run), { value: n }));
  });
  bar.second.prepend(element("option", "none", { value: NONE }));
  bar.second.value = INDEX.runs.length > 1 ? "1" : NONE;
  bar["second-label"].hidden = INDEX.runs.length < 2;
}

clock.onTime.add((now) => {
  bar.time.value = stepOf(now);
  bar.now.textContent = `${now.toFixed(3)} s`;
  bar.time.setAttribute("aria-valuetext", `${digits(now)} seconds`);
  bar.play.textContent = clock.playing && now < clock.end ? "Pause" : "Play";
  bar.play.setAttribute("aria-pressed", String(clock.playing && now < clock.end));
});
bar.time.addEventListener("input", () => clock.set(timeOf(Number(bar.time.value))));
bar.play.addEventListener("click", () => { clock.play(!clock.playing); clock.set(clock.now); });
bar.speed.addEventListener("change", () => { clock.speed = Number(bar.speed.value); });
bar.nearer.addEventListener("click", () => clock.zoomBy(0.5));
bar.farther.addEventListener("click", () => clock.zoomBy(2));
bar.all.addEventListener("click", () => clock.all());
for (const select of [bar.first, bar.second, bar.how]) select.addEventListener("change", show);

// On a narrow screen the bar would hide a third of what it is for.
const wide = matchMedia("(min-width: 60em)");
const unfold = () => { bar.more.open = wide.matches; };
wide.addEventListener("change", unfold);

unfold();
fillRuns();
loadingUntil(show());
