// Profiles of rows: how the greatest kinetic energy lies across a row, of the lens and of what it is compared with.

import { chart } from "./chart.js";
import { state } from "./state.js";
import { make } from "./words.js";

const AGAINST = [["all-host", "host alone"], ["all-lens", "lens material alone"], ["flat-height", "flat strip"]];
let row = null;

export function profile() {
  state.on("scene design", show);
}

function show() {
  const place = document.getElementById("profile");
  const { scene, design, sites } = state;
  if (!scene || !design || scene.materials.length !== sites.x.length) return place.replaceChildren();
  const middle = Math.round((design.foci[0].rows[0] + design.foci[0].rows[1]) / 2);
  const at = row === null || row > design.rows ? middle : row;
  const indices = sites.row.map((of, i) => (of === at ? i : -1)).filter((i) => i >= 0);
  const line = (name, values) => ({ name, x: indices.map((i) => sites.x[i]), y: indices.map((i) => values[i]) });
  const lines = [line(state.painted ? "layout" : "lens", scene.felt.max_kinetic)];
  for (const [name, words] of AGAINST) {
    const other = scene.others.find((other) => other.name === name);
    if (other) lines.push(line(words, other.max_kinetic));
  }
  const field = make("input", { type: "number", min: 1, max: design.rows, value: at, id: "profile-row", "aria-label": "Row of the profile" });
  field.addEventListener("change", () => {
    row = Math.min(design.rows, Math.max(1, Math.round(Number(field.value) || middle)));
    if (row === middle) row = null;
    show();
  });
  if (document.activeElement?.id === "profile-row") return place.lastChild.replaceWith(figure(at, lines));
  place.replaceChildren(make("label", { className: "quiet" }, "Profile of row ", field), figure(at, lines));
}

const figure = (at, lines) => chart({ title: `Greatest kinetic energy across row ${at}`, x: { name: "distance from the axis (D)" }, y: { name: "energy", unit: "J" }, lines });
