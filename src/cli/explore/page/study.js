// A study: start, stop, go on; what has been found, while it is being found.

import { ask } from "./ask.js";
import { LINES, chart } from "./chart.js";
import { state } from "./state.js";
import { digits, make, quantity } from "./words.js";

/// How often the journal is looked at (ms).
const EVERY = 1000;

const at = (name) => document.getElementById(`study-${name}`);
let shown = null; // what the journal held
let open = false;
let showTab = null;

export async function openStudy(show) {
  showTab = show;
  open = true;
  if (!at("file").options.length) {
    const { studies = [] } = await ask("studies", {});
    at("file").append(...studies.map((path) => make("option", { value: path }, path)));
    if (!studies.length) at("words").textContent = "There is no study file in this folder or right below it. A study file names a design, what may change and what is wanted: docs/optimiser.md.";
    at("file").onchange = () => {
      shown = null;
      look();
    };
    at("go").onclick = () => order("study-start");
    at("stop").onclick = () => order("study-stop");
    at("compare").onclick = compare;
  }
  look();
}

export function leaveStudy() {
  open = false;
}

async function order(name) {
  const answer = await ask(name, { path: at("file").value });
  if (answer.error) at("words").textContent = `${answer.error.message} ${answer.error.help ?? ""}`;
  look();
}

async function look() {
  clearTimeout(look.next);
  const path = at("file").value;
  if (!open || !path) return;
  const answer = await ask("study", { path, known: shown?.path === path ? shown.journal : null });
  if (path !== at("file").value) return look();
  if (answer.error) {
    at("words").textContent = `${answer.error.message} ${answer.error.help ?? ""}`;
  } else {
    const { running } = answer;
    if (answer.study) {
      shown = answer;
      draw();
    }
    at("go").disabled = running.runs;
    at("stop").disabled = !running.runs;
    at("go").textContent = shown?.rungs ? "Go on" : "Start";
    at("words").textContent = words(answer);
  }
  look.next = setTimeout(look, EVERY);
}

function words({ running, budget, folder }) {
  const done = shown?.rungs?.reduce((sum, rung) => sum + rung.evaluations, 0) ?? 0;
  const parts = [`${done} of ${budget} evaluations are in the journal of ${folder}`];
  if (running.runs) parts.push("it is running here");
  else if (running.other) parts.push(`${running.other} is running here`);
  if (running.ended?.error) parts.push(`it ended: ${running.ended.error.message}`);
  else if (running.ended) parts.push({ budget: "it has used up its evaluations", "nothing-new": "it found nothing new any more", time: "its time for a run is over; go on to resume", interrupted: "it was stopped; go on to resume" }[running.ended.why] ?? running.ended.why);
  return `${parts.join("; ")}.`;
}

/// The step whose word counts: the finest with evaluations.
function finest() {
  const rungs = shown.rungs?.filter((rung) => rung.evaluations) ?? [];
  return rungs.length ? rungs.reduce((a, b) => (b.step_s < a.step_s ? b : a)) : null;
}

async function take(evaluation) {
  const rung = shown.rungs.indexOf(finest());
  const answer = await ask("study-layout", { path: shown.path, rung, evaluation });
  if (answer.error) {
    at("words").textContent = `${answer.error.message} ${answer.error.help ?? ""}`;
    return;
  }
  state.remember();
  if (state.text !== answer.design) {
    state.text = answer.design;
    state.painted = null;
    await state.look([]);
  }
  state.paint(answer.materials, answer.palette);
  state.rest();
  showTab("design");
}

function draw() {
  const rung = finest();
  const { study, best, front } = shown;
  const wanted = study.wanted.map((name) => study.measures.find((measure) => measure.name === name)).filter(Boolean);
  at("asked").textContent = `Wanted: ${wanted.map((m) => m.symbol).join(", ")}; ${study.sites} sites of ${study.materials.join(", ")}; seed ${study.seed}; ${study.stages.map((stage) => `${stage.method} (${stage.evaluations})`).join(" > ")}.`;
  if (!rung) {
    at("best").replaceChildren();
    at("charts").replaceChildren();
    return;
  }
  if (best) {
    const button = make("button", { type: "button", id: "study-take", className: "main", onclick: () => take(best.evaluation - 1) }, "Show its layout");
    at("best").replaceChildren(
      make("span", {}, make("b", {}, "Best so far: "), `C ${digits(best.contrast, 4)}, G ${digits(best.focal_gain, 4)}, Q ${digits(best.protection, 4)}; evaluation ${best.evaluation} at a step of ${quantity(rung.step_s, "s")}${best.within_limits ? "" : "; misses a limit"} `),
      button,
    );
  }
  const index = (name) => study.measures.findIndex((measure) => measure.name === name);
  const figures = [];
  const rungs = shown.rungs.filter((rung) => rung.best.length);
  figures.push(chart({
    title: "Convergence: least loss so far, by step",
    x: { name: "evaluations at the step" }, y: { name: "loss" }, zero: false,
    lines: rungs.map((rung) => {
      // A stair: each holds until the next.
      const x = [];
      const y = [];
      rung.best.forEach(([k, loss], i) => {
        if (i) x.push(k), y.push(rung.best[i - 1][1]);
        x.push(k), y.push(loss);
      });
      x.push(rung.evaluations), y.push(rung.best.at(-1)[1]);
      return { name: quantity(rung.step_s, "s", 3), x, y };
    }),
  }));
  const inside = rung.kept.filter(([, , within]) => within);
  const [a, b] = front ? front.measures : ["protection", "focal_gain"];
  const [i, j] = [index(a), index(b)];
  if (i >= 0 && j >= 0) {
    const kept = new Map(rung.kept.map((entry) => [entry[0], entry]));
    const members = new Set(front?.evaluations ?? []);
    const group = (name, entries, colour, radius) => ({ name, colour, radius, entries, x: entries.map((e) => e[3][i]), y: entries.map((e) => e[3][j]), words: entries.map((e) => `evaluation ${e[0] + 1}: ${study.measures.map((m, k) => `${m.symbol} ${digits(e[3][k], 4)}`).join(", ")}`) });
    const whole = (entries) => entries.filter((e) => e[3][i] !== null && e[3][j] !== null);
    const others = whole(inside.filter(([k]) => !members.has(k)));
    const lines = [group("evaluations", others.slice(-1500), "#9aa1a8", 2)];
    const onFront = whole([...members].map((k) => kept.get(k)).filter(Boolean));
    if (onFront.length) lines.push(group("front: click for the layout", onFront, LINES[1], 5));
    figures.push(chart({ title: `${study.measures[j].symbol} over ${study.measures[i].symbol}`, x: { name: study.measures[i].symbol }, y: { name: study.measures[j].symbol }, zero: false, points: true, lines, pick: (line, k) => take(line.entries[k][0]), label: `${study.measures[j].symbol} over ${study.measures[i].symbol}, a point an evaluation; Enter shows its layout` }));
  }
  figures.push(parallel(study, inside));
  at("charts").replaceChildren(...figures);
}

/// Parallel coordinates: an axis a measure, a line an evaluation, the better the darker.
function parallel(study, entries) {
  const NS = "http://www.w3.org/2000/svg";
  const element = (name, attributes, text) => {
    const made = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const [width, height, top, bottom, side] = [460, 220, 34, 26, 40];
  const picture = element("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "Parallel coordinates of the best evaluations", class: "chart" });
  picture.append(element("text", { x: side, y: 14, class: "title" }, "The best 200, a line each; the best is drawn strong"));
  const axes = study.measures.map((measure, k) => {
    const values = entries.map((e) => e[3][k]).filter((v) => v !== null);
    return { measure, k, low: Math.min(...values), high: Math.max(...values) };
  }).filter(({ low, high }) => Number.isFinite(low) && Number.isFinite(high));
  const x = (k) => side + (k * (width - 2 * side)) / Math.max(1, axes.length - 1);
  const y = ({ low, high }, value) => height - bottom - ((value - low) / (high - low || 1)) * (height - top - bottom);
  const ranked = [...entries].sort((a, b) => a[1] - b[1]).slice(0, 200);
  ranked.reverse().forEach((entry, k) => {
    if (axes.some((axis) => entry[3][axis.k] === null)) return;
    const first = k === ranked.length - 1;
    const path = axes.map((axis, i) => `${i ? "L" : "M"}${x(i).toFixed(1)} ${y(axis, entry[3][axis.k]).toFixed(1)}`).join("");
    picture.append(element("path", { d: path, fill: "none", stroke: first ? LINES[1] : LINES[0], "stroke-width": first ? 3 : 1, "stroke-opacity": first ? 1 : 0.25 }));
  });
  axes.forEach((axis, i) => {
    picture.append(element("line", { x1: x(i), x2: x(i), y1: top, y2: height - bottom, class: "axis" }), element("text", { x: x(i), y: height - 10, "text-anchor": "middle" }, axis.measure.symbol), element("text", { x: x(i) + 4, y: top - 3 }, digits(axis.high, 3)), element("text", { x: x(i) + 4, y: height - bottom + 1 }, digits(axis.low, 3)));
  });
  return make("figure", { className: "plot" }, picture);
}

async function compare() {
  const folders = at("folders").value.split(",").map((text) => text.trim()).filter(Boolean);
  const answer = await ask("study-compare", { folders });
  at("compared").textContent = answer.error ? `${answer.error.message} ${answer.error.help ?? ""}` : answer.table;
}
