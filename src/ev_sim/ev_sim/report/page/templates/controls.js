"use strict";
// Parameters of the nodes: a slider for each number, and a field for everything.

const ROOM = 2; // a number without two limits slides between zero and so many times its value
const rows = new Map(); // NODE.NAME -> what shows a new value

/** A card with all parameters of a node; `wish(name, value)` asks for another value. */
function cardOf({ node, parameters }, wish) {
  const card = element("details", "", { "data-node": node });
  card.append(element("summary", `${node.replaceAll("_", " ")} (${parameters.length})`));
  const isOfCar = ({ name }) => name.startsWith("vehicle.");
  for (const parameter of parameters.toSorted((a, b) => isOfCar(a) - isOfCar(b))) card.append(rowOf(node, parameter, wish));
  return card;
}

function rowOf(node, parameter, wish) {
  const row = element("div", "", { class: "parameter", "data-name": parameter.name });
  const id = `${node}.${parameter.name}`;
  const isFlag = typeof parameter.value === "boolean";
  const field = element("input", "", { id, type: isFlag ? "checkbox" : "text", autocomplete: "off" });
  field.disabled = parameter.fixed;
  const slider = typeof parameter.value === "number" && !parameter.fixed ? sliderOf(parameter) : null;
  const show = (value) => {
    if (isFlag) field.checked = value;
    else field.value = typeof value === "object" ? JSON.stringify(value) : value;
    if (slider) slider.value = value;
  };
  field.addEventListener("change", () => wish(parameter.name, isFlag ? field.checked : field.value));
  slider?.addEventListener("input", () => { field.value = Number(Number(slider.value).toPrecision(4)); });
  slider?.addEventListener("change", () => wish(parameter.name, String(Number(Number(slider.value).toPrecision(4)))));
  row.append(element("label", parameter.name, { for: id }), field);
  if (slider) row.append(slider);
  const fixed = parameter.fixed ? "; fixed while it runs" : "";
  row.append(element("small", `${[parameter.about, parameter.allowed].filter(Boolean).join("; ")}${fixed}`));
  show(parameter.value);
  rows.set(id, show);
  return row;
}

function sliderOf({ name, value, low, high, whole }) {
  const far = ROOM * Math.abs(value) || 1;
  const [least, most] = [low ?? Math.min(0, Math.sign(value) * far), high ?? Math.max(far, (low ?? 0) + far)];
  const step = whole || (Number.isInteger(value) && most - least > 4) ? "1" : "any";
  return element("input", "", { type: "range", min: least, max: most, step, "aria-label": `${name}, slider` });
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
