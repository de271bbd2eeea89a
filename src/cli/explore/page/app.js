// The page: its parts, its keys, its one line of news.

import { buildControls } from "./controls.js";
import { buildPicture } from "./design.js";
import { buildNumbers } from "./numbers.js";
import { buildSave } from "./save.js";
import { buildPlay, leavePlay, openPlay } from "./play.js";
import { openRank } from "./rank.js";
import { state } from "./state.js";
import { leaveStudy, openStudy } from "./study.js";
import { openSurface } from "./surface.js";
import { digits } from "./words.js";

buildControls();
buildPicture();
buildNumbers();
buildSave();
buildPlay();

// ---- tabs

const VIEWS = { design: [null, null], play: [openPlay, leavePlay], rank: [openRank, null], surface: [openSurface, null], study: [openStudy, leaveStudy] };
let view = "design";

function show(name) {
  if (name !== view) VIEWS[view][1]?.();
  view = name;
  for (const other of Object.keys(VIEWS)) {
    const tab = document.getElementById(`tab-${other}`);
    tab.setAttribute("aria-selected", String(other === name));
    tab.tabIndex = other === name ? 0 : -1;
    document.getElementById(`view-${other}`).hidden = other !== name;
  }
  VIEWS[name][0]?.(show);
}

for (const name of Object.keys(VIEWS)) document.getElementById(`tab-${name}`).addEventListener("click", () => show(name));
document.querySelector("nav").addEventListener("keydown", (event) => {
  const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!by) return;
  const names = Object.keys(VIEWS);
  const next = names[(names.indexOf(view) + by + names.length) % names.length];
  show(next);
  document.getElementById(`tab-${next}`).focus();
});

const undo = document.getElementById("undo");
const redo = document.getElementById("redo");
undo.addEventListener("click", state.undo);
redo.addEventListener("click", state.redo);
state.on("history", () => {
  undo.disabled = !state.past.length;
  redo.disabled = !state.future.length;
});
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
  if (["INPUT", "TEXTAREA"].includes(event.target.tagName)) return;
  event.preventDefault();
  if (event.shiftKey) state.redo();
  else state.undo();
});

const problem = document.getElementById("problem");
state.on("design failure scene stale", () => {
  const what = state.error ?? state.failure;
  problem.hidden = !what;
  problem.textContent = what ? `${what.message} ${what.help ?? ""}` : "";
  document.getElementById("name").textContent = state.keys.name ?? "";
  document.title = `${state.keys.name ?? "granulens"} – explore`;
});

const status = document.getElementById("status");
state.on("design scene busy", () => {
  const parts = [`granulens ${state.about?.version} (commit ${state.about?.commit})`];
  if (state.ms !== undefined) parts.push(`proposal ${digits(state.ms, 2)} ms`);
  if (state.scene) parts.push(`${state.scene.detail} simulation ${digits(state.scene.ms, 3)} ms`);
  if (state.busy) parts.push("simulating …");
  status.textContent = parts.join(" · ");
});

state.begin().then(() => state.about.study && show("study"));
