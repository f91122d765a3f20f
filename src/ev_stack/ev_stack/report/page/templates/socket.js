"use strict";
// What comes from the graph is shown, and what is asked for is sent to it.

const AGAIN = 1000; // ms between attempts to connect
const STILL = 1.5; // s without another instant after which the page says so
const LOST = "no connection: the run or the dashboard has ended; trying again";
const WORDS = 3; // lines that are shown
const byId = (id) => document.getElementById(id);
let socket = null;
let came = 0; // when the last row came [ms]
let pending = false;
clock.follows = true;

function request(what) {
  if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(what));
  else say({ text: "not connected: nothing was asked for", refused: true });
}

function say({ text, refused }) {
  byId("words").prepend(element("li", text, { class: refused ? "refused" : "", title: text }));
  while (byId("words").children.length > WORDS) byId("words").lastChild.remove();
}

const set = (node, name, value) => request({ kind: "set", node, name, value });

function showParameters() {
  showNodes(set);
  showLesson(set);
}

function showNode(message) {
  keepNode(message);
  showParameters();
}

function showLayout(layout) {
  const open = new Map([...document.querySelectorAll("#groups details")].map((each) => [each.dataset.topic, each.open]));
  relaid(layout);
  sight.disconnect();
  widths.disconnect();
  for (const { chart } of plots.values()) chart?.destroy();
  plots.clear();
  showBeside();
  byId("groups").replaceChildren(...live.groups.map((group) => {
    const section = element("details", "", { "data-topic": group.title });
    section.open = open.get(group.title) ?? false;
    const grid = element("div", "", { class: "plots" });
    for (const plot of group.plots) grid.append(quantity(plot, { first: live.run, second: null }));
    section.append(element("summary", group.title), element("p", group.about, { class: "about" }), grid);
    return section;
  }));
  showCars([live.run]);
}

function showRow(buffer) {
  if (!took(new Float64Array(buffer))) return;
  came = performance.now();
  for (const view of views) if (view.ready) view.pass(live.times.length - 1);
  if (pending) return;
  pending = true;
  requestAnimationFrame(draw);
}

/** Draw what has come since the last time, however many rows. */
function draw() {
  pending = false;
  const end = live.times[live.times.length - 1];
  if (end === undefined) return;
  [clock.begin, clock.end] = [live.times[0], Math.max(end, live.times[0] + 1e-3)];
  for (const plot of drawn()) plot.grow();
  for (const view of views) if (view.ready && live.times.length % 20 === 1) view.unit = view.forceOfAnArrow();
  clock.zoom(end - Number(byId("window").value), clock.end);
  clock.set(end);
  byId("now").textContent = `${end.toFixed(3)} s`;
  document.body.dataset.rows = live.times.length;
}

function tellState() {
  if (socket.readyState !== WebSocket.OPEN) return;
  const still = (performance.now() - came) / 1000;
  let waits = came ? "" : "waiting for the first instant";
  if (came && still >= STILL) waits = `no new instant for ${still.toFixed(0)} s: paused, ended or held up`;
  const until = times?.over ? `, ${digits(times.over)} s in all` : "";
  const on = `the car drives on${times?.end ? ` up to ${digits(times.end)} s` : ""}`;
  byId("state").textContent = overAt(live.times.at(-1), `${waits || on}, Reset begins again`) || waits || `running${until}`;
}

/** Another graph, or the same one after a while without connection: nothing of before holds. */
function showTitle({ text }) {
  [times, came] = [null, 0];
  nodes.clear();
  showParameters();
  showLayout({ channels: [], groups: [], car: null });
  document.title = text;
  byId("title").textContent = text;
}

const SHOWN = { title: showTitle, layout: showLayout, node: showNode, word: say, parameter: showValue, gone: showGone };

function showValue({ node, name, value }) {
  nodes.get(node)?.set(name, { ...nodes.get(node).get(name), value });
  for (const show of shows.get(`${node}.${name}`) ?? []) show(value);
}

function showGone({ node }) {
  nodes.delete(node);
  showParameters();
  say({ text: `${node} has left the graph`, refused: false });
}

function connect() {
  socket = new WebSocket(`ws://${location.host}/live`);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => byId("state").classList.remove("lost");
  socket.onmessage = ({ data }) => {
    if (typeof data !== "string") return showRow(data);
    const message = JSON.parse(data);
    SHOWN[message.kind](message);
  };
  socket.onclose = () => {
    const over = overAt(live.times.at(-1));
    byId("state").textContent = over ? `${over} The dashboard has ended with it.` : LOST;
    byId("state").classList.toggle("lost", !over);
    setTimeout(connect, AGAIN);
  };
}

for (const button of document.querySelectorAll("[data-service]"))
  button.addEventListener("click", () => request({ kind: "time", service: button.dataset.service }));
byId("find").addEventListener("input", () => find(byId("find").value));
byId("window").addEventListener("change", draw);
setInterval(tellState, 250);
connect();
