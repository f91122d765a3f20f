"use strict";
// What comes from the graph is shown, and what is wished for is sent to it.

const AGAIN = 1000; // ms between attempts to connect
const STILL = 1.5; // s without another instant after which the page says so
const WORDS = 3; // lines that are shown
const byId = (id) => document.getElementById(id);
let socket = null;
let came = 0; // when the last row came [ms]
let pending = false;
clock.follows = true;

function wish(what) {
  if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(what));
  else say({ text: "not connected: nothing was asked for", refused: true });
}

function say({ text, refused }) {
  byId("words").prepend(element("li", text, { class: refused ? "refused" : "", title: text }));
  while (byId("words").children.length > WORDS) byId("words").lastChild.remove();
}

function showNode(message) {
  const card = cardOf(message, (name, value) => wish({ kind: "set", node: message.node, name, value }));
  const before = document.querySelector(`#nodes [data-node="${message.node}"]`);
  if (before) {
    card.open = before.open;
    before.replaceWith(card);
  } else byId("nodes").append(card);
  if (byId("find").value) find(byId("find").value);
}

function showLayout(layout) {
  const open = new Map([...document.querySelectorAll("#groups details")].map((each) => [each.dataset.topic, each.open]));
  relaid(layout);
  sight.disconnect();
  widths.disconnect();
  for (const { chart } of plots.values()) chart?.destroy();
  plots.clear();
  byId("groups").replaceChildren(...live.groups.map((group, n) => {
    const section = element("details", "", { "data-topic": group.title });
    section.open = open.get(group.title) ?? n < 2;
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
  const waits = came ? `no new instant for ${still.toFixed(0)} s: paused, ended or held up` : "waiting for the first instant";
  byId("state").textContent = came && still < STILL ? "running" : waits;
}

function showTitle({ text }) {
  document.title = text;
  byId("title").textContent = text;
}

const SHOWN = { title: showTitle, layout: showLayout, node: showNode, word: say, parameter: showValue, gone: showGone };

function showValue({ node, name, value }) {
  rows.get(`${node}.${name}`)?.(value);
}

function showGone({ node }) {
  document.querySelector(`#nodes [data-node="${node}"]`)?.remove();
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
    byId("state").textContent = "no connection: the run or the dashboard has ended; trying again";
    byId("state").classList.add("lost");
    setTimeout(connect, AGAIN);
  };
}

for (const button of document.querySelectorAll("[data-service]"))
  button.addEventListener("click", () => wish({ kind: "time", service: button.dataset.service }));
byId("find").addEventListener("input", () => find(byId("find").value));
byId("window").addEventListener("change", draw);
setInterval(tellState, 250);
connect();
