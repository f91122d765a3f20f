"use strict";
// One car seen from above: road, path, wheels, forces.

const BODY = "#9aa5b1";
const PATH = "#56748f";
const FORCE = "#c02942";
const LIGHT = [226, 240, 250]; // of a patch without friction, and of one with friction
const DARK = [58, 70, 80];
const ROOF = 1; // of the body above its axis of roll [m]
const FULL = 1.2; // from which on a patch gets no darker

/** Draw the car of a state into a canvas whose shorter side is `wide` metres, or shows the whole path if 0. */
function drawCar(canvas, view, state, wide) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.clientWidth * ratio;
  canvas.height = canvas.clientHeight * ratio;
  const pen = canvas.getContext("2d");
  const { centre, scale } = frameOf(canvas, view, state, wide);
  pen.setTransform(scale, 0, 0, -scale, canvas.width / 2 - centre[0] * scale, canvas.height / 2 + centre[1] * scale);
  const pixel = ratio / scale;
  drawGrid(pen, canvas, centre, scale, pixel);
  pen.strokeStyle = PATH;
  pen.lineWidth = 1.5 * pixel;
  pen.stroke(view.path);
  pen.translate(state.x, state.y);
  pen.rotate(state.heading);
  const size = Math.max(1, (14 * pixel) / 4); // a car never shrinks below 14 pixels
  pen.scale(size, size);
  drawBody(pen, view.car, state.roll, pixel / size);
  view.car.wheels.forEach((wheel, n) => drawWheel(pen, view, wheel.place, state.wheels[n], pixel / size));
}

function frameOf(canvas, view, state, wide) {
  if (wide) return { centre: [state.x, state.y], scale: Math.min(canvas.width, canvas.height) / wide };
  const [left, right, bottom, top] = view.bounds;
  const scale = Math.min(canvas.width / (right - left + 8), canvas.height / (top - bottom + 8));
  return { centre: [(left + right) / 2, (bottom + top) / 2], scale };
}

function drawGrid(pen, canvas, centre, scale, pixel) {
  const width = canvas.width / scale;
  const height = canvas.height / scale;
  const apart = 10 ** Math.round(Math.log10(Math.min(width, height) / 8));
  pen.strokeStyle = "#e3e8ec";
  pen.lineWidth = pixel;
  pen.beginPath();
  for (let x = Math.ceil((centre[0] - width / 2) / apart) * apart; x < centre[0] + width / 2; x += apart) {
    pen.moveTo(x, centre[1] - height / 2);
    pen.lineTo(x, centre[1] + height / 2);
  }
  for (let y = Math.ceil((centre[1] - height / 2) / apart) * apart; y < centre[1] + height / 2; y += apart) {
    pen.moveTo(centre[0] - width / 2, y);
    pen.lineTo(centre[0] + width / 2, y);
  }
  pen.stroke();
  writeAt(pen, `grid ${digits(apart)} m`, 8, canvas.height - 10, "left");
}

function drawBody(pen, car, roll, pixel) {
  const xs = car.wheels.map((wheel) => wheel.place[0]);
  const ys = car.wheels.map((wheel) => wheel.place[1]);
  const [rear, front] = [Math.min(...xs) - 0.6, Math.max(...xs) + 0.75];
  const [right, left] = [Math.min(...ys), Math.max(...ys)];
  pen.beginPath();
  pen.roundRect(rear, right, front - rear, left - right, 0.45);
  pen.fillStyle = "rgba(200, 208, 216, 0.35)";
  pen.fill();
  pen.strokeStyle = BODY;
  pen.lineWidth = 1.5 * pixel;
  pen.stroke();
  pen.beginPath();
  pen.moveTo(front - 0.5, left - 0.2);
  pen.lineTo(front - 0.12, (left + right) / 2);
  pen.lineTo(front - 0.5, right + 0.2);
  pen.stroke();
  if (!roll) return;
  // The roof leans out of the bend.
  const lean = -ROOF * Math.sin(roll);
  pen.beginPath();
  pen.roundRect(rear + 0.5, right + 0.15 + lean, front - rear - 1.7, left - right - 0.3, 0.3);
  pen.stroke();
}

function drawWheel(pen, view, [x, y], wheel, pixel) {
  const long = view.car.radius;
  pen.save();
  pen.translate(x, y);
  if (wheel.friction != null) {
    pen.fillStyle = colourOf(wheel.friction);
    pen.fillRect(-1.5 * long, -0.95 * long, 3 * long, 1.9 * long);
    const place = pen.getTransform().transformPoint({ x: 0, y: Math.sign(y) * 1.7 * long });
    writeAt(pen, `μ ${wheel.friction.toFixed(2)}`, place.x, place.y, "center");
  }
  pen.rotate(wheel.angle || 0);
  pen.fillStyle = "#1b1f23";
  pen.strokeStyle = "#ffffff";
  pen.lineWidth = pixel;
  pen.fillRect(-long, -0.32 * long, 2 * long, 0.64 * long);
  pen.strokeRect(-long, -0.32 * long, 2 * long, 0.64 * long);
  if (wheel.along != null) drawArrow(pen, wheel.along / view.unit, wheel.across / view.unit, pixel);
  pen.restore();
}

function drawArrow(pen, x, y, pixel) {
  const length = Math.hypot(x, y);
  if (length < 0.02) return;
  const head = Math.min(0.16, 0.5 * length);
  const [ux, uy] = [x / length, y / length];
  pen.strokeStyle = pen.fillStyle = FORCE;
  pen.lineWidth = 3 * pixel;
  pen.beginPath();
  pen.moveTo(0, 0);
  pen.lineTo(x - ux * head * 0.8, y - uy * head * 0.8);
  pen.stroke();
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x - ux * head - uy * head * 0.55, y - uy * head + ux * head * 0.55);
  pen.lineTo(x - ux * head + uy * head * 0.55, y - uy * head - ux * head * 0.55);
  pen.fill();
}

function writeAt(pen, text, x, y, align) {
  pen.save();
  pen.resetTransform();
  pen.font = `${12 * (window.devicePixelRatio || 1)}px system-ui, sans-serif`;
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.lineWidth = 3;
  pen.strokeStyle = "#ffffff";
  pen.fillStyle = "#1b1f23";
  pen.strokeText(text, x, y);
  pen.fillText(text, x, y);
  pen.restore();
}

function colourOf(friction) {
  const part = Math.min(Math.max(friction / FULL, 0), 1);
  return `rgb(${LIGHT.map((light, n) => Math.round(light + (DARK[n] - light) * part)).join(" ")})`;
}
