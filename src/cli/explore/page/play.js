// The wave as it runs: frames on the canvas, a baseline beside it in lockstep, a sphere's history, the ledger.

import { askBytes } from "./ask.js";
import { LINES, chart } from "./chart.js";
import { Crystal, Scale, quantile } from "./crystal.js";
import { inkOf } from "./design.js";
import { state } from "./state.js";
import { digits, make, quantity } from "./words.js";

const CHANNELS = [
  ["speed", "speed", "m/s"],
  ["kinetic", "kinetic energy", "J"],
  ["force", "net force", "N"],
  ["dissipated", "dissipated so far", "J"],
];
/// Frames of a run, and how long it is shown at the usual speed (s).
const FRAMES = 240;
const SHOWN = 8;

let run = null; // { header, frames: [Float32Array, ...] }
let of = null; // what it is a run of
let frame = 0;
let playing = false;
let chosen = -1;
let views = [];
const painted = [];
globalThis.granulens = Object.assign(globalThis.granulens ?? {}, { frames: painted });

const at = (name) => document.getElementById(`play-${name}`);

export function buildPlay() {
  at("channel").append(...CHANNELS.map(([name, label]) => make("option", { value: name }, label)));
  at("channel").value = "kinetic";
  at("channel").addEventListener("change", show);
  at("log").addEventListener("change", show);
  at("beside").addEventListener("change", load);
  at("go").addEventListener("click", () => (playing ? pause() : go()));
  at("frame").addEventListener("input", () => {
    pause();
    frame = Number(at("frame").value);
    show();
  });
  document.getElementById("view-play").addEventListener("keydown", (event) => {
    if (event.key !== " " || ["BUTTON", "SELECT", "INPUT"].includes(event.target.tagName)) return;
    event.preventDefault();
    if (playing) pause();
    else go();
  });
  new ResizeObserver(() => requestAnimationFrame(() => {
    if (views.map(({ crystal }) => crystal.fit()).some(Boolean)) show();
  })).observe(at("views"));
}

/// The tab is shown: what it shows is made, if it is not that of the present design.
export function openPlay() {
  const others = state.scene?.others ?? [];
  const names = others.map((other) => other.name);
  const was = at("beside").value;
  at("beside").replaceChildren(make("option", { value: "" }, "nothing"), ...names.map((name) => make("option", { value: name, selected: name === was }, name)));
  if (!of || of.text !== state.text || of.painted !== state.painted) load();
}

export function leavePlay() {
  pause();
}

async function load() {
  if (!state.layout || state.error) {
    at("words").textContent = "There is no layout to run: the design has no lens yet.";
    return;
  }
  pause();
  at("words").textContent = "running …";
  const { text, painted } = state;
  const beside = at("beside").value || null;
  const answer = await askBytes("play", { text, layout: painted, beside, frames: FRAMES });
  if (answer.error) {
    at("words").textContent = answer.error.kind === "interrupted" ? "" : `${answer.error.message} ${answer.error.help ?? ""}`;
    return;
  }
  const length = new DataView(answer.bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(answer.bytes, 4, length)));
  let from = 4 + length;
  const frames = header.runs.map(({ times_s }) => {
    const count = times_s.length * header.spheres * header.channels;
    const numbers = new Float32Array(answer.bytes, from, count);
    from += 4 * count;
    return numbers;
  });
  run = { header, frames };
  of = { text, painted };
  frame = 0;
  chosen = -1;
  const last = Math.min(...header.runs.map(({ times_s }) => times_s.length)) - 1;
  at("frame").max = last;
  build();
  show();
  tellRuns();
}

/// A canvas a run.
function build() {
  views = run.header.runs.map(({ name, materials }) => {
    const canvas = make("canvas", { tabIndex: 0, role: "img", "aria-label": `${name}: arrow keys choose a sphere, blank plays` });
    const stage = make("div", { className: "stage" }, canvas);
    const box = make("figure", {}, make("figcaption", {}, make("b", {}, name)), stage);
    const crystal = new Crystal(canvas);
    canvas.addEventListener("pointermove", (event) => {
      const place = canvas.getBoundingClientRect();
      choose(crystal.at(...crystal.back(event.clientX - place.left, event.clientY - place.top)));
    });
    canvas.addEventListener("keydown", (event) => {
      const next = crystal.step(chosen, event.key);
      if (next === null) return;
      event.preventDefault();
      choose(next);
    });
    return { box, crystal, materials };
  });
  at("views").replaceChildren(...views.map(({ box }) => box));
  at("views").classList.toggle("two", views.length > 1);
  for (const { crystal } of views) crystal.take(state.sites, state.design.half_width, state.design.rows, state.design.row_spacing);
}

/// The numbers of a frame.
function values(k, channel, number = frame) {
  const { spheres, channels } = run.header;
  const start = (number * channels + channel) * spheres;
  return run.frames[k].subarray(start, start + spheres);
}

/// One scale for all runs and frames: by the greatest value that a sphere behind the struck rows comes to.
function scaleOf(channel) {
  const kept = (run.scales ??= {});
  const logarithmic = at("log").checked;
  const key = `${channel}-${logarithmic}`;
  if (kept[key]) return kept[key];
  const { spheres } = run.header;
  const greatest = [];
  run.header.runs.forEach(({ times_s }, k) => {
    const most = new Float32Array(spheres);
    for (let number = 0; number < times_s.length; number += 1) {
      const now = values(k, channel, number);
      for (let i = 0; i < spheres; i += 1) if (now[i] > most[i]) most[i] = now[i];
    }
    const last = Math.min(...state.design.foci.map((focus) => focus.rows[0])) / 2;
    most.forEach((value, i) => state.sites.row[i] > last && greatest.push(value));
  });
  const high = quantile(greatest, 0.99);
  return (kept[key] = new Scale(state.about.scale[0], logarithmic ? high / 1e4 : 0, high, logarithmic));
}

function show() {
  if (!run) return;
  const begun = performance.now();
  const channel = CHANNELS.findIndex(([name]) => name === at("channel").value);
  const scale = scaleOf(channel);
  views.forEach(({ crystal, materials }, k) => {
    const numbers = values(k, channel);
    const inks = inkOf(run.header.palette);
    const letter = (i) => (materials[i] ? [inks[materials[i]][2], numbers[i] > scale.high / 2 ? "#111" : "#fff"] : null);
    crystal.draw({ fill: (i) => scale.colour(numbers[i]), letter, chosen });
  });
  at("frame").value = frame;
  const time = run.header.runs[0].times_s[frame];
  at("time").textContent = quantity(time, "s");
  at("frame").setAttribute("aria-valuetext", quantity(time, "s"));
  const [, label, unit] = CHANNELS[channel];
  at("scale").textContent = `${label}: dark ${scale.logarithmic ? `below ${quantity(scale.low, unit, 2)}` : "0"}, light ${quantity(scale.high, unit, 2)} and more`;
  if (!playing) slow();
  else if (performance.now() - (show.last ?? 0) > 250) slow();
  painted.push(performance.now() - begun);
  if (painted.length > 2000) painted.shift();
}

/// What is drawn less often than the spheres: ledger and history.
function slow() {
  show.last = performance.now();
  const time = run.header.runs[0].times_s[frame];
  const line = (name, of, k, runOf = 0) => ({ name, x: run.header.runs[runOf].times_s, y: run.header.runs[runOf].ledger.map(of), colour: LINES[k] });
  const parts = [["work in", (l) => l.work_in], ["kinetic", (l) => l.kinetic], ["stored", (l) => l.stored + l.tangential_stored], ["dissipated", (l) => l.dissipated + l.friction]];
  const figures = run.header.runs.map(({ name }, k) => chart({ title: `Energy ledger, ${name}`, x: { name: "time", unit: "s" }, y: { name: "energy of the half", unit: "J" }, lines: parts.map(([label, of], p) => line(label, of, p, k)), marker: time }));
  if (chosen >= 0) {
    const channel = CHANNELS.findIndex(([name]) => name === at("channel").value);
    const [, label, unit] = CHANNELS[channel];
    const history = run.header.runs.map(({ name, times_s }, k) => ({ name, x: times_s, y: times_s.map((_, number) => values(k, channel, number)[chosen]) }));
    figures.unshift(chart({ title: `Row ${state.sites.row[chosen]}, column ${state.sites.column[chosen]}: ${label}`, x: { name: "time", unit: "s" }, y: { name: label, unit }, lines: history, marker: time }));
  }
  at("charts").replaceChildren(...figures);
}

function choose(i) {
  if (i === chosen) return;
  chosen = i;
  tellSphere();
  show();
}

function tellSphere() {
  if (chosen < 0) return tellRuns();
  const { row, column, x } = state.sites;
  const lines = run.header.runs.map(({ name, materials, arrival, greatest_speed, greatest_force, times_s }, k) => {
    const lost = values(k, 3, times_s.length - 1)[chosen];
    return `${name}: ${run.header.palette[materials[chosen]]}, at most ${quantity(greatest_speed[chosen], "m/s")} and ${quantity(greatest_force[chosen], "N")}, ${arrival[chosen] === null ? "not reached" : `reached at ${quantity(arrival[chosen], "s")}`}, lost ${quantity(lost, "J")}`;
  });
  at("words").textContent = `Row ${row[chosen]}, column ${column[chosen]}, ${digits(x[chosen], 3)} D off the axis. ${lines.join(". ")}.`;
}

function tellRuns() {
  const stops = run.header.runs.filter(({ stop }) => stop).map(({ name, stop }) => `${name} was stopped: ${stop}`);
  at("words").textContent = stops.length ? `${stops.join(". ")}.` : "Point at a sphere, or focus a crystal and use the arrow keys: its history stands below. Run by Verlet, as granulens simulate does.";
}

function go() {
  if (!run) return;
  const last = Number(at("frame").max);
  if (frame >= last) frame = 0;
  playing = true;
  at("go").textContent = "Pause";
  let since = performance.now();
  let exact = frame;
  const step = (now) => {
    if (!playing) return;
    exact += ((now - since) / 1e3 / SHOWN) * last * Number(at("speed").value);
    since = now;
    const next = Math.min(last, Math.floor(exact));
    if (next !== frame) {
      frame = next;
      show();
    }
    if (frame >= last) return pause();
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function pause() {
  if (!playing) return;
  playing = false;
  at("go").textContent = "Play";
  if (run) slow();
}
