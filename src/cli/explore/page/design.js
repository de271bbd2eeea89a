// The crystal with its regions: what is dragged, what is drawn, what is read.

import { regionKeys } from "./controls.js";
import { Crystal, Scale, quantile } from "./crystal.js";
import { beginStroke, buildPaint, endStroke, paintAt, painting } from "./paint.js";
import { profile } from "./profile.js";
import { askSlow, known } from "./slow.js";
import { state } from "./state.js";
import { digits, make, percent, quantity } from "./words.js";

const MAPS = [
  ["materials", "materials"],
  ["max_kinetic", "greatest kinetic energy", "J"],
  ["arrival", "arrival", "s"],
  ["max_net_force", "greatest net force", "N"],
  ["dissipated", "dissipated energy", "J"],
  ["swaps", "what exchanging a sphere does to C"],
  ["focal_mean:d_density", "F and G by each sphere's density"],
  ["focal_mean:secant_density", "F and G by density, over 1 % (secant)"],
  ["focal_mean:d_youngs_modulus", "F and G by Young's modulus"],
  ["focal_mean:d_radius", "F and G by radius"],
  ["protected_mean:d_density", "P and Q by density"],
  ["protected_mean:secant_density", "P and Q by density, over 1 % (secant)"],
];

/// Which of the maps that take seconds a map is: swaps, sensitivity, or none.
const slow = (name) => (name === "swaps" ? name : name.includes(":") ? "sensitivity" : null);

/// What is known of the measure whose derivatives a map shows, and which of them; null where it shows others or they are not known.
function derivatives(name) {
  const [measure, which] = name.split(":");
  const of = which && known("sensitivity")?.sensitivities.find((one) => one.measure === measure);
  return of ? { of, which, values: of[which], names: measure === "focal_mean" ? "F and G" : "P and Q" } : null;
}

let crystal;
let chosen = -1;
const regions = new Map();

/// Drags, measured: from the pointer's move to the picture that follows it (ms).
const latency = [];
globalThis.granulens = Object.assign(globalThis.granulens ?? {}, { latency, state });

export function buildPicture() {
  const canvas = document.getElementById("crystal");
  crystal = new Crystal(canvas);
  const map = document.getElementById("map");
  map.append(...MAPS.map(([name, label]) => make("option", { value: name }, label)));
  map.value = "max_kinetic";
  map.addEventListener("change", () => (draw(), rested()));
  document.getElementById("sensitivity").addEventListener("click", () => {
    map.value = map.value.includes(":") ? "materials" : "focal_mean:d_density";
    map.dispatchEvent(new Event("change"));
  });
  for (const layer of ["rays", "fronts", "faces"]) document.getElementById(`layer-${layer}`).addEventListener("change", draw);
  state.on("design painted", () => {
    take();
    draw();
    if (state.since_drawn) {
      const since = state.since_drawn;
      requestAnimationFrame(() => latency.push(performance.now() - since));
      if (latency.length > 1000) latency.shift();
    }
  });
  state.on("scene stale failure", draw);
  state.on("scene", rested);
  new ResizeObserver(() => requestAnimationFrame(() => {
    if (crystal.fit()) draw();
  })).observe(canvas.parentElement);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  read(canvas);
  buildPaint(draw);
  profile();
}

/// What takes seconds is asked for when all else is known.
function rested() {
  const kind = slow(document.getElementById("map").value);
  if (kind && state.scenes?.whole) askSlow(kind, draw);
}

function take() {
  const { design, sites } = state;
  if (design && crystal.sites !== sites) {
    chosen = -1;
    crystal.take(sites, design.half_width, design.rows, design.row_spacing);
  }
}

/// Inks by the place of a material in the palette that is shown: the host first.
export function inkOf(palette) {
  return palette.map((_, place) => state.about.inks[Math.min(place, state.about.inks.length - 1)]);
}

/// The map that is chosen, if its numbers are there; otherwise what can be drawn.
function shown() {
  const name = document.getElementById("map").value;
  const scene = fitting();
  const values = name === "materials" ? null : name === "swaps" ? known("swaps")?.each.map((swap) => swap.change) : slow(name) ? derivatives(name)?.values : scene?.felt[name];
  return { name, scene, values: values?.length ? values : null };
}

/// The scene, where it belongs to the crystal that is drawn.
function fitting() {
  return state.scene && state.sites && state.scene.materials.length === state.sites.x.length ? state.scene : null;
}

/// Draws with the browser's next frame, however much changes until then: a drag changes text, lens and numbers one after the other.
export function draw() {
  if (due) return;
  due = true;
  requestAnimationFrame(() => {
    due = false;
    drawNow();
  });
}

let due = false;

function drawNow() {
  if (!state.design || !crystal.sites) return;
  const { name, values } = shown();
  const layout = state.layout;
  const inks = inkOf(layout?.palette ?? [state.design.host]);
  let fill;
  let letter = null;
  let scale = null;
  if (values) {
    scale = scaleOf(name, values);
    fill = (i) => scale.colour(values[i]);
    const linear = derivatives(name)?.of.linear;
    if (linear) letter = (i) => (linear[i] ? null : ["•", Math.abs(values[i]) > 0.6 * scale.high ? "#ffffff" : "#111111"]);
  } else {
    const place = (i) => layout?.materials[i] ?? 0;
    fill = (i) => inks[place(i)][0];
    letter = (i) => (place(i) ? [inks[place(i)][2], inks[place(i)][1]] : null);
  }
  crystal.draw({ fill, letter, chosen, lines: lines(Boolean(values)), quick: state.moving });
  document.getElementById("stage").classList.toggle("old", Boolean(values) && !layout);
  placeRegions();
  legend(name, values, scale, inks, layout);
  tell();
}

/// A linear scale ends where 99 of 100 values behind the lens are below: the struck rows would drown all else.
function scaleOf(name, values) {
  const [colours, diverging] = state.about.scale;
  if (name === "swaps") {
    const most = Math.max(...values.map((value) => Math.abs(value ?? 0)), 1e-9);
    return new Scale(diverging, -most, most);
  }
  const slopes = derivatives(name);
  if (slopes) {
    // As in reports: by density as far as its secants reach.
    const most = quantile((slopes.which === "d_density" ? slopes.of.secant_density : values).map(Math.abs), 0.99);
    return new Scale(diverging, -most, most);
  }
  if (name === "arrival") return new Scale(colours, 0, Math.max(...values.filter((value) => value !== null), 1e-12));
  const last = Math.max(...state.lastRows(), 1);
  const behind = values.filter((_, i) => state.sites.row[i] > last);
  return new Scale(colours, 0, quantile(behind.length ? behind : values, 0.99));
}

state.lastRows = () => {
  const layout = state.layout;
  if (!layout) return [1];
  let last = 1;
  layout.materials.forEach((material, i) => {
    if (material && state.sites.row[i] > last && state.sites.row[i] < Math.min(...state.design.foci.map((focus) => focus.rows[0]))) last = state.sites.row[i];
  });
  return [last];
};

function lines(onMap) {
  const { lens } = state;
  const layer = (name) => document.getElementById(`layer-${name}`).checked;
  if (!lens || state.painted) return [];
  const drawn = [];
  if (layer("fronts")) for (const { lines } of lens.fronts) for (const points of lines) drawn.push({ points, colour: onMap ? "#ffffff" : "#0b5394", width: 0.8, alpha: onMap ? 0.55 : 0.5 });
  if (layer("rays")) lens.rays.forEach((points, k) => k % 2 === 0 && drawn.push({ points, colour: onMap ? "#ffffff" : "#9e3a00", width: 1, alpha: onMap ? 0.6 : 0.8 }));
  if (layer("faces")) for (const points of lens.faces) drawn.push({ points, colour: "#111111", width: 1.6, halo: 1.6 });
  return drawn;
}

function legend(name, values, scale, inks, layout) {
  const place = document.getElementById("legend");
  if (!values) {
    const used = new Set(layout?.materials ?? [0]);
    const names = layout?.palette ?? [state.design.host];
    const doing = { swaps: "every sphere is being exchanged …", sensitivity: "derivatives by every sphere are being found, and secants …" }[slow(name)];
    const waits = doing && make("span", { className: "quiet" }, doing);
    place.replaceChildren(...[waits].filter(Boolean), ...names.map((material, k) => used.has(k) && make("span", { className: "material" }, make("i", { style: `background:${inks[k][0]};color:${inks[k][1]}` }, inks[k][2]), material)).filter(Boolean));
    return;
  }
  const bar = make("canvas", { width: scale.colours.length, height: 1 });
  const ctx = bar.getContext("2d");
  scale.colours.forEach((colour, k) => {
    ctx.fillStyle = colour;
    ctx.fillRect(k, 0, 1, 1);
  });
  if (name === "swaps") {
    const { noise } = known("swaps");
    place.replaceChildren(make("span", {}, `C ${percent(scale.low)} `), bar, make("span", {}, ` +${percent(scale.high)}, by the best other material, both halves alike; below ${percent(noise, 2)} is chance`));
    return;
  }
  const slopes = derivatives(name);
  if (slopes) {
    const { of, which, names } = slopes;
    const quantity = { d_density: "density", secant_density: "density", d_youngs_modulus: "Young's modulus", d_radius: "radius" }[which];
    const beyond = values.filter((value) => Math.abs(value) > scale.high).length;
    const trust = of.linear_share === null ? "no sphere matters" : `linear over 1 % of density at ${percent(of.linear_share, 2)} of the spheres that matter; dots: not linear`;
    place.replaceChildren(
      make("span", {}, `${names} ${digits(scale.low, 2)} % `),
      bar,
      make("span", {}, ` +${digits(scale.high, 2)} % for 1 % more ${quantity} of a sphere, both halves alike, white at zero; ${trust}${beyond ? `; ${beyond} spheres lie beyond the scale` : ""}`),
    );
    return;
  }
  const [, label, unit] = MAPS.find(([key]) => key === name);
  const above = values.filter((value) => value > scale.high).length;
  place.replaceChildren(
    make("span", {}, `${label}: 0 `),
    bar,
    make("span", {}, ` ${quantity(scale.high, unit, 2)}${above ? `; ${above} spheres above take the last colour` : ""}`),
  );
}

// ---- regions

function placeRegions() {
  const stage = document.getElementById("stage");
  const keys = regionKeys(state.keys);
  const places = [...state.design.foci, state.design.protect];
  if (keys.length !== places.length) return;
  for (const [key, element] of regions) if (!keys.includes(key)) element.remove(), regions.delete(key);
  keys.forEach((key, k) => {
    let element = regions.get(key);
    if (!element) {
      element = region(key);
      regions.set(key, element);
      stage.append(element);
    }
    const at = element.moving ?? places[k];
    const { rows, x } = at;
    const pad = 0.25;
    const right = x[1] > state.design.half_width - pad ? x[1] + 0.5 : x[1] + pad;
    const left = x[0] < pad ? -0.5 : x[0] - pad;
    const [px, py] = crystal.place(left, (rows[0] - 1.5) * crystal.spacing);
    const [qx, qy] = crystal.place(right, (rows[1] - 0.5) * crystal.spacing);
    Object.assign(element.style, { left: `${px}px`, top: `${py}px`, width: `${qx - px}px`, height: `${qy - py}px` });
    const name = key === "target.protect" ? "protected" : keys.length > 2 ? `focus ${k + 1}` : "focus";
    element.firstChild.textContent = name;
    const words = `${name} region, rows ${rows[0]} to ${rows[1]}, ${x[0]} to ${x[1]} D off the axis; arrow keys move it, with Shift they resize it`;
    if (element.getAttribute("aria-label") !== words) element.setAttribute("aria-label", words);
  });
}

function region(key) {
  const element = make("div", { className: `region ${key === "target.protect" ? "protect" : "focus"}`, tabIndex: 0, role: "group", "data-key": key }, make("span"));
  element.style.setProperty("--region", key === "target.protect" ? "#9e3a00" : "#0b5394");
  for (const edge of ["left", "right", "top", "bottom"]) element.append(make("i", { "data-edge": edge }));
  element.addEventListener("pointerdown", (event) => drag(event, key, element, event.target.dataset.edge ?? null));
  element.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [-0.5, 0], ArrowRight: [0.5, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    const now = current(key);
    const next = event.shiftKey ? resized(now, step[0] ? "right" : "bottom", step) : moved(now, step);
    send(key, next);
  });
  return element;
}

/// The region as the text says it.
function current(key) {
  const places = [...state.design.foci, state.design.protect];
  const { rows, x } = places[regionKeys(state.keys).indexOf(key)];
  return { rows: [...rows], x: [...x] };
}

const half = (x) => Math.round(2 * x) / 2;
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

function moved({ rows, x }, [dx, dr]) {
  const { half_width, rows: last } = state.design;
  const shift = clamp(half(dx), -x[0], half_width - x[1]);
  const down = clamp(Math.round(dr), 1 - rows[0], last - rows[1]);
  return { rows: rows.map((row) => row + down), x: x.map((end) => end + shift) };
}

function resized({ rows, x }, edge, [dx, dr]) {
  const { half_width, rows: last } = state.design;
  const next = { rows: [...rows], x: [...x] };
  if (edge === "left") next.x[0] = clamp(half(x[0] + dx), 0, x[1]);
  if (edge === "right") next.x[1] = clamp(half(x[1] + dx), x[0], half_width);
  if (edge === "top") next.rows[0] = clamp(Math.round(rows[0] + dr), 1, rows[1]);
  if (edge === "bottom") next.rows[1] = clamp(Math.round(rows[1] + dr), rows[0], last);
  return next;
}

function send(key, { rows, x }) {
  state.change([{ key: `${key}.rows`, value: rows }, { key: `${key}.x`, value: x.map((end) => `${end} D`) }]);
}

function drag(event, key, element, edge) {
  if (event.button) return;
  event.preventDefault();
  element.focus({ preventScroll: true });
  element.setPointerCapture(event.pointerId);
  const from = [event.clientX, event.clientY];
  const begun = current(key);
  let last = JSON.stringify(begun);
  state.grasp();
  const move = (event) => {
    const by = [(event.clientX - from[0]) / crystal.scale, (event.clientY - from[1]) / crystal.scale / crystal.spacing];
    const next = edge ? resized(begun, edge, by) : moved(begun, by);
    const now = JSON.stringify(next);
    if (now === last) return;
    last = now;
    element.moving = next;
    placeRegions();
    send(key, next);
  };
  const end = () => {
    element.removeEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel"]) element.removeEventListener(name, end);
    (state.looking ?? Promise.resolve()).then(() => {
      element.moving = null;
      draw();
      state.release();
    });
  };
  element.addEventListener("pointermove", move);
  for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, end);
}

// ---- reading a sphere

function read(canvas) {
  const under = (event) => {
    const box = canvas.getBoundingClientRect();
    return crystal.at(...crystal.back(event.clientX - box.left, event.clientY - box.top));
  };
  let stroking = false;
  canvas.addEventListener("pointerdown", (event) => {
    if (!painting() || event.button || !beginStroke()) return;
    stroking = true;
    canvas.setPointerCapture(event.pointerId);
    paintAt(under(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const i = under(event);
    if (stroking) paintAt(i);
    choose(i);
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => {
    if (stroking) endStroke();
    stroking = false;
  });
  canvas.addEventListener("pointerleave", () => document.activeElement !== canvas && choose(-1));
  canvas.addEventListener("keydown", (event) => {
    if (event.key === " " && painting() && chosen >= 0 && beginStroke()) {
      event.preventDefault();
      paintAt(chosen);
      return endStroke();
    }
    const next = crystal.step(chosen, event.key);
    if (next === null) return;
    event.preventDefault();
    choose(next);
  });
}

function choose(i) {
  if (i === chosen) return;
  chosen = i;
  draw();
}

/// The sphere under the pointer, in words.
function tell() {
  const place = document.getElementById("sphere");
  if (chosen < 0 || chosen >= state.sites.x.length) return;
  const { row, column, x } = state.sites;
  const layout = state.layout;
  const scene = fitting();
  const felt = scene?.felt;
  const parts = [`row ${row[chosen]}, column ${column[chosen]}, ${digits(x[chosen], 3)} D off the axis: ${layout ? layout.palette[layout.materials[chosen]] : state.design.host}`];
  if (felt?.max_kinetic?.length) parts.push(`greatest kinetic energy ${quantity(felt.max_kinetic[chosen], "J", 4)}`);
  if (felt?.max_net_force?.length) {
    parts.push(`net force ${quantity(felt.max_net_force[chosen], "N")}`, `contact force ${quantity(felt.max_contact_force[chosen], "N")}`);
    parts.push(felt.arrival[chosen] === null ? "not reached" : `reached at ${quantity(felt.arrival[chosen], "s")}`, `dissipated ${quantity(felt.dissipated[chosen], "J")}`);
  }
  const name = document.getElementById("map").value;
  const slopes = derivatives(name);
  if (slopes) {
    const { of, names } = slopes;
    const part = (list) => `${list[chosen] > 0 ? "+" : ""}${digits(list[chosen], 3)} %`;
    parts.push(
      `for 1 % more density ${names} ${part(of.d_density)} (derivative), ${part(of.secant_density)} (secant): ${of.linear[chosen] ? "linear" : "not linear"}`,
      `Young's modulus ${part(of.d_youngs_modulus)}, radius ${part(of.d_radius)}`,
    );
  }
  const swap = name === "swaps" ? known("swaps")?.each[chosen] : null;
  if (swap) parts.push(swap.change === null ? `${swap.material} here stops the run` : `${swap.material} here: C ${swap.change > 0 ? "+" : ""}${percent(swap.change)}`);
  place.textContent = `${parts.join("; ")}.`;
}
