// Saving, and the command that gives the same numbers.

import { ask } from "./ask.js";
import { state } from "./state.js";
import { make } from "./words.js";

const saved = { design: null, layout: null };
let dialog;

export function buildSave() {
  dialog = document.getElementById("dialog");
  document.getElementById("save").addEventListener("click", showSave);
  document.getElementById("command").addEventListener("click", showCommand);
}

/// A name that the file given at the start does not have.
const name = () => (state.keys.name ?? "my-lens").replace(/[^A-Za-z0-9_-]/g, "-");
const designPath = () => (state.about.given && state.about.file === `${name()}.toml` ? `${name()}-2.toml` : `${name()}.toml`);

function showSave() {
  const rows = [
    ["design", "Design file", designPath()],
    ["layout", "Layout, simulated half", `${name()}.csv`],
    ["layout-full", "Layout, whole piece", `${name()}-full.csv`],
    ["report", "Report (folder; seconds)", `reports/${name()}`],
  ].map(([what, label, path]) => {
    const field = make("input", { value: path, "aria-label": `${label}: place` });
    const said = make("span", { className: "quiet", role: "status" });
    const button = make("button", { type: "button", id: `save-${what}`, disabled: what !== "design" && !state.layout }, `Save ${label.toLowerCase().split(/[,(]/)[0].trim()}${what === "layout-full" ? " (whole)" : ""}`);
    button.addEventListener("click", async () => {
      button.disabled = true;
      said.textContent = "…";
      const answer = await ask("save", { what, path: field.value.trim(), text: state.text, layout: state.painted });
      button.disabled = false;
      said.textContent = answer.error ? `${answer.error.message} ${answer.error.help ?? ""}` : `saved as ${answer.saved}`;
      said.className = answer.error ? "worse" : "better";
      if (!answer.error && what in saved) saved[what] = { path: answer.saved, text: state.text, painted: state.painted };
    });
    return make("div", { className: "row" }, make("label", {}, `${label} `), field, button, said);
  });
  open("Save", make("p", { className: "quiet" }, "Below the folder in which granulens explore was started. A file that is not granulens's own is never replaced."), ...rows);
}

/// Quoted for a shell.
const quoted = (path) => (/^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`);

function showCommand() {
  const design = saved.design?.text === state.text ? saved.design.path : state.text === state.about.text && state.about.given ? state.about.file : null;
  const layout = state.painted ? (saved.layout?.painted === state.painted ? saved.layout.path : null) : undefined;
  const missing = [design === null && "the design", layout === null && "the layout"].filter(Boolean).join(" and ");
  const files = [quoted(design ?? designPath()), ...(layout === undefined ? [] : [quoted(layout ?? `${name()}.csv`)])].join(" ");
  const lines = [
    [`granulens compare ${files}`, "C, G, Q and the verdict, as shown here when the hand rests"],
    ...(state.painted ? [] : [[`granulens design ${quoted(design ?? designPath())}`, "the proposal, by rays"], [`granulens run ${quoted(design ?? designPath())}`, "all of it, with a report"]]),
  ];
  open("As command", missing ? make("p", { className: "warning" }, `Save ${missing} first: what is shown is not in a file yet.`) : null, ...lines.map(([line, what]) => make("div", {}, make("pre", {}, make("code", {}, line)), make("p", { className: "quiet" }, what))));
}

function open(title, ...children) {
  dialog.replaceChildren(make("form", { method: "dialog" }, make("h2", {}, title), ...children.filter(Boolean), make("div", { className: "row" }, make("button", { value: "close" }, "Close"))));
  dialog.showModal();
}
