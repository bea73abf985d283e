"use strict";
// The 3D view: reads the points inside the page, draws the frame that the slider stands at, turns with the mouse.

const view = document.getElementById("view");
const part = (name) => view.querySelector(`[data-part="${name}"]`);
const [canvas, slider, clock, playing, colouring, speed] = ["canvas", "slider", "clock", "play", "colouring", "speed"].map(part);
const labels = part("labels"), layerBoxes = [...view.querySelectorAll("[data-layer]")];
const header = JSON.parse(document.getElementById("view-header").textContent);
const TURN = Math.PI / 24, SHRINK = 0.88;
let drawing, cloud, dots, ground, palette, offsets, camera, home, asked = false, last = 0, elapsed = 0;

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

function columnsOf(buffer) {
  const count = buffer.byteLength / 9;
  const column = (number) => new Uint8Array(buffer, (6 + number) * count, count);
  return { places: new Uint16Array(buffer, 0, 3 * count), motion: column(0), segment: column(1), confidence: column(2) };
}

// The paths as dots, dense where the motion was observed and sparse where it was completed; lines would be hair-thin.
function pathDots() {
  const places = [], colours = [];
  for (const { colour, places: own, observed } of header.curves) {
    for (let i = 0; i < observed.length; i++) {
      const next = Math.min(i + 1, observed.length - 1);
      const steps = observed[i] && observed[next] ? 6 : 1;
      for (let step = 0; step < steps; step++) {
        for (let axis = 0; axis < 3; axis++) {
          places.push(own[3 * i + axis] + (step / steps) * (own[3 * next + axis] - own[3 * i + axis]));
        }
        colours.push(colour);
      }
    }
  }
  return ownCloud(places, colours);
}

// A dot every 10 cm on lines a metre apart, below all that there is.
function groundDots() {
  const places = [], [x0, , z0] = header.low.map(Math.floor);
  const [x1, , z1] = header.low.map((value, axis) => Math.ceil(value + header.span[axis]));
  for (let x = x0; x <= x1; x++) for (let z = z0; z <= z1; z += 0.1) places.push(x, 0, z);
  for (let z = z0; z <= z1; z++) for (let x = x0; x <= x1; x += 0.1) places.push(x, 0, z);
  return ownCloud(places, new Array(places.length / 3).fill(8));
}

function ownCloud(places, colours) {
  const low = [0, 1, 2].map((axis) => places.reduce((least, value, i) => (i % 3 === axis ? Math.min(least, value) : least), Infinity));
  const span = [0, 1, 2].map((axis) => places.reduce((most, value, i) => (i % 3 === axis ? Math.max(most, value - low[axis]) : most), 1e-3));
  const motion = Uint8Array.from(colours);
  const scaled = Uint16Array.from(places, (value, i) => Math.round(((value - low[i % 3]) / span[i % 3]) * 65535));
  const made = drawing.cloud({ places: scaled, motion, segment: motion, confidence: new Uint8Array(motion.length).fill(255) }, low, span);
  return { ...made, count: motion.length };
}

function start(buffer) {
  drawing = new Drawing(canvas);
  cloud = drawing.cloud(columnsOf(buffer), header.low, header.span);
  palette = new Float32Array(header.palette.flatMap((text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255)));
  offsets = {};
  let offset = 0;
  for (const [name, starts] of Object.entries(header.layers)) {
    offsets[name] = offset;
    offset += starts[starts.length - 1];
  }
  if (header.curves.length) dots = pathDots();
  if (header.ground) ground = groundDots();
  const aspect = canvas.clientWidth / canvas.clientHeight;
  home = { target: header.target, distance: header.radius * Math.max(1.6, 3.2 / aspect), yaw: -0.3, pitch: 0.38 };
  camera = { ...home };
  for (const { motion, colour } of header.curves) {
    const label = document.createElement("span");
    label.textContent = motion;
    label.style.borderColor = header.palette[colour];
    labels.append(label);
  }
  view.dataset.state = "ready";
  redraw();
}

const shown = (name) => layerBoxes.some((box) => box.dataset.layer === name && box.checked);

function draw() {
  asked = false;
  const frame = Number(slider.value);
  const matrix = clipFromWorld(camera, canvas.clientWidth / canvas.clientHeight);
  drawing.begin(matrix, palette, Number(colouring.value));
  const layer = (name, options, at = frame) => {
    const starts = header.layers[name];
    if (starts && shown(name)) drawing.points(cloud, offsets[name] + starts[at], starts[at + 1] - starts[at], options);
  };
  if (ground) drawing.points(ground, 0, ground.count, { size: 0.012, paleness: 0.1, smallest: 1.3 });
  layer("still", { size: 0.012, smallest: 1.5 }, 0);
  layer("truth", { size: 0.03 });
  layer("observed", { size: 0.05, smallest: 2 });
  layer("completed", { size: 0.06, ring: true, smallest: 4 });
  if (dots && shown("curves")) drawing.points(dots, 0, dots.count, { size: 0.02, smallest: 2.5 });
  drawLabels(matrix, frame);
}

function drawLabels(matrix, frame) {
  header.curves.forEach(({ frames, places }, number) => {
    const label = labels.children[number], at = frame - frames[0];
    label.hidden = !shown("curves") || at < 0 || at >= frames.length || frames[at] !== frame;
    if (label.hidden) return;
    const place = [places[3 * at], places[3 * at + 1], places[3 * at + 2], 1];
    const [x, y, , w] = [0, 1, 2, 3].map((row) => place.reduce((sum, value, k) => sum + matrix[4 * k + row] * value, 0));
    label.hidden = w <= 0 || Math.abs(x) > w || Math.abs(y) > w;
    label.style.transform = `translate(${((x / w + 1) / 2) * canvas.clientWidth}px, ${((1 - y / w) / 2) * canvas.clientHeight}px)`;
  });
}

function redraw() {
  if (!asked && drawing) {
    asked = true;
    requestAnimationFrame(draw);
  }
}

function goTo(frame) {
  slider.value = Math.max(0, Math.min(Number(slider.max), frame));
  const text = `frame ${slider.value}, ${(slider.value / header.fps).toFixed(2)} s`;
  clock.textContent = text;
  slider.setAttribute("aria-valuetext", text);
  redraw();
}

function play(on) {
  playing.textContent = on ? "Pause" : "Play";
  if (!on) return;
  if (slider.value === slider.max) goTo(0);
  [last, elapsed] = [performance.now(), 0];
  requestAnimationFrame(tick);
}

const isPlaying = () => playing.textContent === "Pause";

function tick(now) {
  if (!isPlaying()) return;
  elapsed += ((now - last) / 1000) * header.fps * Number(speed.value);
  last = now;
  const steps = Math.floor(elapsed);
  elapsed -= steps;
  if (steps) goTo(Number(slider.value) + steps);
  if (slider.value === slider.max) play(false);
  else requestAnimationFrame(tick);
}

function turn(yaw, pitch) {
  camera.yaw += yaw;
  camera.pitch = Math.max(-1.5, Math.min(1.55, camera.pitch + pitch));
  redraw();
}

function zoom(factor) {
  camera.distance = Math.max(0.3, Math.min(100, camera.distance * factor));
  redraw();
}

function shift(right, up) {
  const [sy, cy, sp, cp] = [Math.sin(camera.yaw), Math.cos(camera.yaw), Math.sin(camera.pitch), Math.cos(camera.pitch)];
  const [x, y, z] = camera.target;
  camera.target = [x - right * cy - up * sy * sp, y + up * cp, z + right * sy - up * cy * sp];
  redraw();
}

function dragged(event) {
  if (!event.buttons) return;
  const [across, down] = [event.movementX, event.movementY], metres = camera.distance / canvas.clientHeight;
  if (event.shiftKey || event.buttons & 2) shift(across * metres * 0.7, down * metres * 0.7);
  else turn(-across * 0.008, down * 0.008);
}

// Arrows step through time and with Shift turn the scene; buttons, sliders and lists keep their own keys.
function pressed(event) {
  const own = event.target.closest("button, select, input");
  const keys = {
    " ": () => play(!isPlaying()),
    ArrowLeft: () => (event.shiftKey ? turn(-TURN, 0) : goTo(Number(slider.value) - 1)),
    ArrowRight: () => (event.shiftKey ? turn(TURN, 0) : goTo(Number(slider.value) + 1)),
    ArrowUp: () => turn(0, TURN),
    ArrowDown: () => turn(0, -TURN),
    Home: () => goTo(0),
    End: () => goTo(Number(slider.max)),
    "+": () => zoom(SHRINK),
    "-": () => zoom(1 / SHRINK),
  };
  if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey || (own && !(own === slider && event.key === " "))) return;
  event.preventDefault();
  keys[event.key]();
}

function listen() {
  slider.addEventListener("input", () => goTo(Number(slider.value)));
  playing.addEventListener("click", () => play(!isPlaying()));
  part("back").addEventListener("click", () => goTo(Number(slider.value) - 1));
  part("forth").addEventListener("click", () => goTo(Number(slider.value) + 1));
  part("home").addEventListener("click", () => ((camera = { ...home }), redraw()));
  part("above").addEventListener("click", () => ((camera = { ...home, yaw: 0, pitch: 1.55 }), redraw()));
  for (const control of [colouring, ...layerBoxes]) control.addEventListener("change", redraw);
  view.addEventListener("keydown", pressed);
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", dragged);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => (event.preventDefault(), zoom(event.deltaY > 0 ? 1 / SHRINK : SHRINK)), { passive: false });
  window.addEventListener("resize", redraw);
  for (const button of document.querySelectorAll("[data-frame]")) {
    button.addEventListener("click", () => {
      play(false);
      goTo(Number(button.dataset.frame));
      view.scrollIntoView({ block: "start" });
      canvas.focus({ preventScroll: true });
    });
  }
}

goTo(Number(slider.value));
unpacked(document.getElementById("view-points").textContent.trim())
  .then(start)
  .then(listen)
  .catch((error) => {
    view.dataset.state = "failed";
    part("failure").hidden = false;
    part("failure").textContent = `The 3D view cannot be shown here: ${error.message}.`;
  });
