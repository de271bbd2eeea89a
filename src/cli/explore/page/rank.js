// Which material is good: all of them in all families, by rays, by first arrivals, the best by simulation.

import { ask } from "./ask.js";
import { state } from "./state.js";
import { digits, make, percent, quantity } from "./words.js";

/// How many of the best by rays are simulated.
const SIMULATED = 8;

const COLUMNS = [
  ["material", (r) => r.material, (r) => r.material],
  ["family", (r) => r.family, (r) => r.family],
  ["C", (r) => -(r.scores?.contrast ?? -Infinity), (r) => (r.stop ? "stopped" : digits(r.scores?.contrast ?? null, 3))],
  ["G", (r) => -(r.scores?.focal_gain ?? -Infinity), (r) => digits(r.scores?.focal_gain ?? null, 3)],
  ["Q", (r) => r.scores?.protection ?? Infinity, (r) => digits(r.scores?.protection ?? null, 3)],
  ["rays to the focus", (r) => -(r.fraction?.[0] ?? -Infinity), (r) => percent(r.fraction?.[0])],
  ["rays past the protected", (r) => r.protected?.[0] ?? Infinity, (r) => percent(r.protected?.[0])],
  ["delay by first arrivals", (r) => -(r.delay_s ?? -Infinity), (r) => quantity(r.delay_s, "s")],
  ["speed ratio", (r) => -(r.speed_ratio ?? -Infinity), (r) => digits(r.speed_ratio, 3)],
  ["spheres", (r) => r.spheres ?? Infinity, (r) => String(r.spheres ?? "–")],
  ["mass of the piece", (r) => r.mass_kg ?? Infinity, (r) => quantity(r.mass_kg * 1e3, "g")],
];

let ranking = null;
let of = null;
let order = null;

const at = (name) => document.getElementById(`rank-${name}`);

export function openRank(show) {
  at("again").onclick = () => load(show);
  if (of !== state.text) load(show);
}

async function load(show) {
  const { text } = state;
  at("words").textContent = "ranking …";
  for (const simulate of [0, SIMULATED]) {
    const answer = await ask("rank", { text, simulate });
    if (answer.cancelled || text !== state.text) return;
    if (answer.error) {
      at("words").textContent = `${answer.error.message} ${answer.error.help ?? ""}`;
      return;
    }
    ranking = answer.ranking;
    of = text;
    at("words").textContent = simulate
      ? `In ${answer.host}. The best ${SIMULATED} by rays are simulated under the design's own force: granulens design FILE --rank --simulate ${SIMULATED} says the same. Choose one to take it into the design.`
      : "By rays and first arrivals; the best are being simulated …";
    draw(show);
  }
}

function draw(show) {
  const can = ranking.filter((r) => !r.refused);
  if (order !== null) can.sort((a, b) => (COLUMNS[order][1](a) < COLUMNS[order][1](b) ? -1 : COLUMNS[order][1](a) > COLUMNS[order][1](b) ? 1 : 0));
  const take = (r) => {
    const family = state.about.families.find((family) => family.name === r.family);
    const edits = [{ key: "lens.family", value: r.family }, { key: "lens.material", value: r.material }];
    for (const [key, leave] of [["lens.others", true], ["lens.radius", true], ["lens.axis", !family.has_axis], ...Object.keys(state.keys).filter((key) => key === "lens.stages" || key.startsWith("lens.parameters.")).map((key) => [key, !family.parameters.some((own) => own.name === key.split(".").at(-1))])]) {
      if (leave && state.keys[key] !== undefined) edits.push({ key, value: null });
    }
    state.painted = null;
    state.change(edits);
    show("design");
  };
  const current = (r) => state.lens && r.family === state.lens.proposal.family && r.material === state.lens.palette[1];
  at("table").replaceChildren(
    make("thead", {}, make("tr", {}, ...COLUMNS.map(([name], k) => make("th", { scope: "col", "aria-sort": order === k ? "ascending" : "none" }, make("button", { type: "button", className: "plain", onclick: () => ((order = k), draw(show)) }, name))))),
    make("tbody", {}, ...can.map((r) => make("tr", { className: current(r) ? "current" : "" }, ...COLUMNS.map(([, , words], k) => make("td", {}, k ? words(r) : make("button", { type: "button", className: "plain", title: "take it into the design", onclick: () => take(r) }, words(r))))))),
  );
  const refused = ranking.filter((r) => r.refused);
  at("refused").replaceChildren(
    make("summary", {}, `${refused.length} that cannot be`),
    make("ul", {}, ...refused.map((r) => make("li", {}, make("b", {}, `${r.material}, ${r.family}: `), r.refused))),
  );
}
