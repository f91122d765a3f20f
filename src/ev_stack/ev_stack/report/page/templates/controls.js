"use strict";
// Parameters of the nodes: a slider for each number, and a field for everything.

const OF_CAR = "vehicle.";
const EDGE = 0.05; // of a slider's range, where it goes on to a range about its value
const nodes = new Map(); // name -> {parameter -> what the node says of it}
const shows = new Map(); // NODE.NAME -> functions that show a new value

/** Keep the parameters of a node. */
function keepNode({ node, parameters }) {
  nodes.set(node, new Map(parameters.map((parameter) => [parameter.name, parameter])));
}

/** Show all nodes anew, and the car once: a node has only those of its parameters that are not as in the plant. */
function showNodes(request) {
  const open = new Set([...document.querySelectorAll("#nodes details[open]")].map((card) => card.dataset.node));
  shows.clear();
  const car = [...(nodes.get("plant")?.values() ?? [])].filter(isOfCar);
  const cards = [...nodes].map(([node, parameters]) => cardOf(node, node, [...parameters.values()].filter(isOwn), request));
  if (car.length) cards.push(cardOf("vehicle", "plant", car, request));
  for (const card of cards) card.open = open.has(card.dataset.node);
  byId("nodes").replaceChildren(...cards);
  if (byId("find").value) find(byId("find").value);
}

const isOfCar = ({ name }) => name.startsWith(OF_CAR);

function isOwn(parameter) {
  const shared = isOfCar(parameter) && nodes.get("plant")?.get(parameter.name);
  return !shared || (shared !== parameter && JSON.stringify(shared.value) !== JSON.stringify(parameter.value));
}

function cardOf(title, node, parameters, request) {
  const card = element("details", "", { "data-node": title });
  card.append(element("summary", `${title.replaceAll("_", " ")} (${parameters.length})`));
  for (const parameter of parameters) card.append(rowOf(node, parameter, parameter.name, request));
  return card;
}

/** A row that shows a parameter under a label and asks for another value by `request(node, name, value)`. */
function rowOf(node, parameter, label, request) {
  const row = element("div", "", { class: "parameter", "data-name": parameter.name });
  const id = `${node}.${parameter.name}`;
  const isFlag = typeof parameter.value === "boolean";
  const field = element("input", "", { type: isFlag ? "checkbox" : "text", autocomplete: "off" });
  field.disabled = parameter.fixed;
  const slider = typeof parameter.value === "number" && !parameter.fixed ? sliderOf(parameter) : null;
  const show = (value) => {
    if (isFlag) field.checked = value;
    else field.value = typeof value === "object" ? JSON.stringify(value) : value;
    slider?.follow(value);
  };
  const ask = (value) => request(node, parameter.name, value);
  field.addEventListener("change", () => ask(isFlag ? field.checked : field.value));
  slider?.input.addEventListener("input", () => { field.value = slider.value(); });
  slider?.input.addEventListener("change", () => ask(slider.value()));
  const named = element("label", label.replace(/[._]/g, "$&\u200b")); // where a long name may be broken
  named.append(field);
  row.append(named);
  if (slider) row.append(slider.box);
  const fixed = parameter.fixed ? "; fixed while it runs" : "";
  row.append(element("small", `${[parameter.about, parameter.allowed].filter(Boolean).join("; ")}${fixed}`));
  show(parameter.value);
  shows.set(id, [...(shows.get(id) ?? []), show]);
  return row;
}

/** A slider between zero and twice the value, within what is allowed; when it comes to an end, about the value there. */
function sliderOf(parameter) {
  const input = element("input", "", { type: "range", step: "any", "aria-label": `${parameter.name}, slider` });
  const [least, most] = [element("span"), element("span")];
  const box = element("div", "", { class: "slide" });
  box.append(least, input, most);
  let [low, high] = [NaN, NaN];
  const follow = (value) => {
    const edge = EDGE * (high - low);
    if (!(value > low + edge && value < high - edge)) {
      [low, high] = rangeAbout(value, parameter, (high - low) / 2);
      Object.assign(input, { min: low, max: high, step: parameter.whole ? 1 : "any" });
      [least.textContent, most.textContent] = [digits(low), digits(high)];
    }
    input.value = value;
  };
  return { input, box, follow, value: () => String(Number(Number(input.value).toPrecision(4))) };
}

/** About a value as far as to zero, about zero as far as before or by one; within what is allowed. */
function rangeAbout(value, { low, high }, before) {
  const far = Math.abs(value) || before || 1;
  return [Math.max(low ?? -Infinity, value - far), Math.min(high ?? Infinity, value + far)];
}

/** Show only the parameters whose name holds a text, in open cards. */
function find(text) {
  for (const card of document.querySelectorAll("#nodes details")) {
    const found = [...card.querySelectorAll(".parameter")].filter((row) => {
      row.hidden = !row.dataset.name.includes(text);
      row.style.display = row.hidden ? "none" : "";
      return !row.hidden;
    });
    card.hidden = !found.length;
    if (text) card.open = found.length > 0;
  }
}
