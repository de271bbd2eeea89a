// Painting spheres by hand: brush, rows, swap, each with its mirror image in the other half.

import { state } from "./state.js";
import { make } from "./words.js";

const brush = { material: null, size: 0, tool: "brush" };
let bar;

export const painting = () => bar && !bar.hidden;

export function buildPaint(redraw) {
  const toggle = document.getElementById("paint");
  bar = document.getElementById("paintbar");
  toggle.addEventListener("click", () => {
    bar.hidden = !bar.hidden;
    toggle.setAttribute("aria-pressed", String(!bar.hidden));
    document.getElementById("stage").classList.toggle("painting", !bar.hidden);
    const map = document.getElementById("map");
    if (!bar.hidden && map.value !== "swaps") map.value = "materials";
    fill();
    redraw();
  });
  state.on("design painted", fill);
}

/// The names that may be painted with: what the layout holds, then all others that are known.
function names() {
  const known = (state.design?.materials ?? []).map((material) => material.name);
  const held = state.layout?.palette ?? [state.design.host];
  return [...held, ...known.filter((name) => !held.includes(name))];
}

let drawn = "";

function fill() {
  if (bar.hidden || !state.design) return;
  const all = names();
  const about = JSON.stringify([all, brush, Boolean(state.painted)]);
  if (about === drawn) return;
  drawn = about;
  if (!all.includes(brush.material)) brush.material = all[1] ?? all[0];
  const materials = all.map((name, place) => {
    const ink = state.about.inks[Math.min(place, state.about.inks.length - 1)];
    const input = make("input", { type: "radio", name: "ink", value: name, checked: brush.material === name });
    input.addEventListener("change", () => (brush.material = name));
    return make("label", { className: "material" }, input, make("i", { style: `background:${ink[0]};color:${ink[1]}` }, ink[2]), name);
  });
  const choice = (label, key, options) => {
    const select = make("select", { "aria-label": label, id: `brush-${key}` }, ...options.map(([value, words]) => make("option", { value, selected: String(brush[key]) === String(value) }, words)));
    select.addEventListener("change", () => (brush[key] = key === "size" ? Number(select.value) : select.value));
    return make("label", {}, `${label} `, select);
  };
  const back = make("button", { type: "button", id: "unpaint", disabled: !state.painted, onclick: () => state.forgetPaint() }, "Back to the proposed lens");
  bar.replaceChildren(
    make("span", { role: "radiogroup", "aria-label": "Paint with" }, ...materials),
    choice("Tool", "tool", [["brush", "brush"], ["row", "whole rows"], ["line", "row, from the axis to here"]]),
    choice("Size", "size", [[0, "1 sphere"], [1, "7 spheres"], [2, "19 spheres"]]),
    back,
    make("button", { type: "button", id: "swaps", onclick: showSwaps, title: "Every sphere is exchanged by itself, which takes some seconds" }, "Where would a sphere help?"),
    make("span", { className: "quiet" }, "Both halves are painted alike. Space paints the sphere that the arrow keys chose."),
  );
}

/// The map of what exchanging each sphere does.
function showSwaps() {
  const map = document.getElementById("map");
  map.value = map.value === "swaps" ? "materials" : "swaps";
  map.dispatchEvent(new Event("change"));
}

/// Begins a stroke; its undo takes back all of it.
export function beginStroke() {
  if (!state.layout) return false;
  state.grasp();
  stroke = state.layout.materials.slice();
  return true;
}

let stroke = null;

/// Paints what the tool covers at a sphere.
export function paintAt(i) {
  if (i < 0 || !stroke) return;
  const { palette } = state.layout;
  const inks = palette.includes(brush.material) ? palette : [...palette, brush.material];
  const place = inks.indexOf(brush.material);
  const { x, z, row } = state.sites;
  const reach = (brush.size + 0.1) ** 2;
  const covers = {
    brush: (k) => (x[k] - x[i]) ** 2 + (z[k] - z[i]) ** 2 <= reach || (x[k] + x[i]) ** 2 + (z[k] - z[i]) ** 2 <= reach,
    row: (k) => Math.abs(row[k] - row[i]) <= brush.size,
    line: (k) => Math.abs(row[k] - row[i]) <= brush.size && x[k] <= x[i] + 1e-9,
  }[brush.tool];
  let changed = false;
  for (let k = 0; k < x.length; k += 1) {
    if (stroke[k] !== place && covers(k)) {
      stroke[k] = place;
      changed = true;
    }
  }
  if (changed) state.paint(stroke.slice(), inks);
}

export function endStroke() {
  if (!stroke) return;
  stroke = null;
  state.release();
}
