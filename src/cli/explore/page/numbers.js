// The numbers beside the picture: verdict, scores, what rays say.

import { state } from "./state.js";
import { digits, make, percent, quantity } from "./words.js";

const NAMES = { contrast: "C", focal_gain: "G", protection: "Q" };

export function buildNumbers() {
  state.on("design painted scene stale failure", show);
}

const section = (title, ...children) => [make("h2", {}, title), ...children];

function show() {
  const place = document.getElementById("numbers");
  if (!state.design) return;
  place.replaceChildren(...[problem(), ...simulated(), ...rays()].flat().filter(Boolean));
}

function problem() {
  const what = state.unreachable ?? null;
  if (!what || state.painted) return null;
  return make("div", { className: "failure", id: "unreachable" }, make("b", {}, "No lens: "), what.message.replace(/^.*?: lens: /, ""), " ", make("span", { className: "quiet" }, what.help ?? ""));
}

/// Everything that was simulated: of the finest detail that has come.
function simulated() {
  const { scene } = state;
  if (!scene || !state.layout) return [];
  const { numbers } = scene;
  const subject = numbers.arrangements[0];
  const old = scene.turn !== state.turn ? " stale" : "";
  const box = (symbol, value, words, id) => make("div", { title: words }, make("small", {}, symbol), make("b", { id }, digits(value, 3)), make("small", {}, words));
  const scores = subject.scores;
  const spread = (name) => {
    const sd = subject.over_forces?.[`${name}_sd`];
    return sd ? ` ± ${digits(sd, 2)} over ${numbers.forces_N.length} forces` : "";
  };
  return [
    ...section("Simulated"),
    make("div", { className: `big${old}` },
      box("C = F/P", scores.contrast, `focus over protected${spread("contrast")}`, "score-C"),
      box("G", scores.focal_gain, `focus over host alone${spread("focal_gain")}`, "score-G"),
      box("Q", scores.protection, `protected over ${numbers.reference ?? "lens material"} alone${spread("protection")}`, "score-Q")),
    verdict(numbers, old),
    make("dl", { className: old.trim() },
      make("dt", {}, "F, P"), make("dd", {}, `${quantity(scores.focal_mean_J, "J")}, ${quantity(scores.protected_mean_J, "J")}`),
      make("dt", {}, "step"), make("dd", {}, `${quantity(numbers.step_s, "s")} (${detailWords(scene)})`)),
    ...numbers.warnings.map((warning) => make("p", { className: "warning" }, warning)),
    make("details", {}, make("summary", {}, "All arrangements"), make("pre", {}, scene.words)),
  ];
}

function detailWords(scene) {
  const { coarse, fine } = state.scenes;
  const off = coarse && fine ? ["contrast", "focal_gain", "protection"].map((name) => {
    const [a, b] = [coarse, fine].map((scene) => scene.numbers.arrangements[0].scores[name]);
    return a && b ? `${NAMES[name]} ${digits(100 * (a / b - 1), 2)} %` : null;
  }).filter(Boolean).join(", ") : "";
  if (scene.detail === "coarse") return "coarse, finer numbers follow";
  return `fine${off ? `; the coarse step was off by ${off}` : ""}${scene.detail === "whole" ? "" : "; judged over several forces next"}`;
}

function verdict(numbers, old) {
  const kinds = ["flat", "uniform", "random"];
  const rows = Object.entries(NAMES).map(([measure, symbol]) => make("tr", {}, make("td", {}, symbol), ...kinds.map((against) => {
    const of = numbers.verdict.find((line) => line.measure === measure && line.against === against);
    if (!of) return make("td", {}, "–");
    return make("td", { title: `best ${against}: ${of.arrangement}, ${digits(of.best, 4)}` }, make("span", { className: of.word }, of.word), ` (${digits(of.best, 3)})`);
  })));
  const over = numbers.forces_N?.length > 1 ? `over ${numbers.forces_N.length} forces` : "at one force";
  return make("table", { className: `words${old}`, id: "verdict" }, make("caption", {}, `Verdict ${over}: against the best`), make("thead", {}, make("tr", {}, ...["", ...kinds].map((kind) => make("th", { scope: "col" }, kind)))), make("tbody", {}, ...rows));
}

function rays() {
  const { lens } = state;
  if (!lens || state.painted) return [];
  const of = lens.proposal;
  const diameter = state.design.diameter_m;
  const inD = (length) => (length === null || length === undefined ? "none" : `${digits(length / diameter, 3)} D`);
  const facts = [
    ["Speeds", `${digits(of.host_speed_m_s, 4)} and ${digits(of.lens_speed_m_s, 4)} m/s (host, lens)`],
    ["Speed ratio", digits(of.speed_ratio, 3)],
    ["Critical angle", of.critical_angle_rad === null ? "none" : `${digits((of.critical_angle_rad * 180) / Math.PI, 3)}°`],
    ["F/F_p", `${digits(of.amplitude_host, 3)} (host), ${digits(of.amplitude_lens, 3)} (lens)`],
    ["Bound holds", of.validity],
    ["Rows", `${of.apex_row} to ${of.back_row}`],
    ["Radius", inD(of.radius_m)],
    ...Object.entries(of.parameters ?? {}).map(([name, value]) => (name.endsWith("_m") ? [name.slice(0, -2).replaceAll("_", " "), inD(value)] : [name, digits(value, 3)])),
    ["Axis, half aperture", `${inD(of.axis_m)}, ${inD(of.aperture_m)}`],
    ["Steepest face", of.rim_angle_rad === undefined ? "–" : `${digits((of.rim_angle_rad * 180) / Math.PI, 3)}°`],
    ["Rays to the focus", `${percent(of.fraction)} (${percent(of.fraction_without)} straight on)`],
    ["Rays to the protected", `${percent(of.protected[0])} (${percent(of.protected[1])} straight on)`],
    ["Arrival", of.arrival_s ? `${quantity(of.arrival_s[0], "s")} to ${quantity(of.arrival_s[1], "s")}` : "never"],
    ["Piece", `${of.piece.counts.map((count, k) => `${count} ${of.materials[k]}`).join(", ")}; ${quantity(of.piece.mass_kg * 1e3, "g")}`],
  ];
  return [
    ...section("By rays"),
    make("dl", { id: "rays" }, ...facts.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)])),
    ...of.warnings.map((warning) => make("p", { className: "warning" }, warning)),
  ];
}
