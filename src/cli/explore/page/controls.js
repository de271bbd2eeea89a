// The controls: each is a key of the design file, written as the file writes it.

import { state } from "./state.js";
import { make } from "./words.js";

/// Key, label, hint, and the way in which it is chosen.
const GROUPS = [
  ["Crystal", [
    ["crystal.diameter", "diameter D", { hint: "6.35 mm" }],
    ["crystal.rows", "rows", { whole: true }],
    ["crystal.half_width", "half width (D)", { number: true }],
    ["crystal.host", "host", { materials: "all" }],
    ["crystal.law", "contact law", { laws: true }],
  ]],
  ["Impact", [
    ["impact.force", "force on a sphere", { hint: "26 kN" }],
    ["impact.duration", "duration", { hint: "20 us" }],
  ]],
  ["Lens", [
    ["lens.family", "family", { families: true }],
    ["lens.material", "material", { materials: "foreign" }],
    ["lens.others", "further materials", { others: true }],
    ["lens.rows", "rows", { rows: true }],
    ["lens.max_interface_angle", "steepest face", { hint: "60 deg", optional: true }],
    ["lens.radius", "radius", { hint: "solved", optional: true }],
    ["lens.axis", "axis at", { hint: "solved", optional: true }],
    ["lens.stages", "stages", { whole: true, optional: true, hint: "2" }],
  ]],
  ["Run", [
    ["run.accuracy", "accuracy", { options: ["0.1 %", "1 %"], optional: true }],
    ["run.window", "window", { hint: "chosen", optional: true }],
  ]],
];

const REGION = { rows: true };
const controls = new Map();

/// The keys of the regions: one focus or several.
export function regionKeys(keys) {
  const several = Object.keys(keys).map((key) => /^target\.focus\.(\d+)\.rows$/.exec(key)?.[1]).filter((k) => k !== undefined);
  const foci = several.length ? several.sort((a, b) => a - b).map((k) => `target.focus.${k}`) : ["target.focus"];
  return [...foci, "target.protect"];
}

export function buildControls() {
  const form = document.getElementById("controls");
  form.addEventListener("submit", (event) => event.preventDefault());
  let regions = "";
  state.on("design", () => {
    if (!state.design && !state.keys) return;
    const wanted = regionKeys(state.keys).join();
    if (wanted !== regions) {
      regions = wanted;
      build(form, wanted.split(","));
    }
    fill();
  });
  state.on("failure", fill);
}

function build(form, regions) {
  controls.clear();
  const named = (key, k) => (key === "target.protect" ? "protected" : regions.length > 2 ? `focus ${k + 1}` : "focus");
  const target = ["Target", regions.flatMap((key, k) => [
    [`${key}.rows`, `${named(key, k)} rows`, REGION],
    [`${key}.x`, `${named(key, k)} x`, { ends: true }],
  ])];
  const groups = [GROUPS[0], GROUPS[1], target, ...GROUPS.slice(2).map(([title, list]) => [title, title === "Lens" ? [...list, ...ownParameters()] : list])];
  form.replaceChildren(
    ...groups.map(([title, list]) => make("fieldset", {}, make("legend", {}, title), ...list.map(([key, label, kind]) => control(key, label, kind)))),
    textPanel(),
  );
}

/// The parameters that families have of their own, each name once; stages have a key that is older.
function ownParameters() {
  const all = state.about.families.flatMap((family) => family.parameters).filter((own) => own.name !== "stages");
  const once = all.filter((own, k) => all.findIndex((other) => other.name === own.name) === k);
  return once.map((own) => [`lens.parameters.${own.name}`, own.name.replaceAll("_", " "), { number: own.quantity === "number", whole: own.quantity === "count", optional: true, hint: "sought" }]);
}

/// Whether a family has what a key of the lens asks for.
const has = (family, key) => !!family?.parameters.some((own) => own.name === key.split(".").at(-1));

let serial = 0;

function control(key, label, kind) {
  const id = `control-${(serial += 1)}`;
  const why = make("span", { className: "why", id: `${id}-why` });
  const send = (value) => {
    const old = state.keys[key];
    if (JSON.stringify(value) !== JSON.stringify(old ?? null)) state.change([{ key, value }]);
  };
  let field;
  let show;
  if (kind.rows || kind.ends) {
    const ends = [0, 1].map((k) => make("input", { id: k ? `${id}-to` : id, inputMode: kind.rows ? "numeric" : "text", "aria-label": `${label}, ${k ? "to" : "from"}`, "aria-describedby": why.id, placeholder: "chosen" }));
    const read = (text) => (kind.rows ? Number(text) : /^[-+.\d]+$/.test(text.trim()) ? `${text.trim()} D` : text.trim());
    for (const end of ends) {
      end.addEventListener("change", () => {
        const texts = ends.map((input) => input.value.trim());
        if (texts.every((text) => !text)) send(null);
        else if (texts.every((text) => text)) send(texts.map(read));
      });
    }
    field = make("span", { className: "pair" }, ends[0], "to", ends[1]);
    show = (value) => ends.forEach((input, k) => set(input, value?.[k] ?? ""));
  } else if (kind.others) {
    field = make("span", { className: "choices", role: "group", "aria-label": label });
    show = (value) => {
      const chosen = value ?? [];
      const names = (state.design?.materials ?? []).map((material) => material.name);
      const foreign = names.filter((name) => name !== state.design.host && name !== canonical(state.keys["lens.material"]));
      const boxes = foreign.map((name) => {
        const box = make("input", { type: "checkbox", checked: chosen.map(canonical).includes(name) });
        box.addEventListener("change", () => {
          const next = box.checked ? [...chosen, name] : chosen.filter((other) => canonical(other) !== name);
          send(next.length ? next : null);
        });
        return make("label", {}, box, ` ${name}`);
      });
      field.replaceChildren(...boxes);
      const family = state.about.families.find((family) => family.name === state.keys["lens.family"]);
      row.hidden = !family?.takes_others;
    };
  } else if (kind.materials || kind.laws || kind.families || kind.options) {
    field = make("select", { id, "aria-describedby": why.id });
    field.addEventListener("change", () => {
      if (kind.families) return family(field.value);
      send(field.value === "" ? null : field.value);
    });
    show = (value) => {
      const names = (state.design?.materials ?? []).map((material) => material.name);
      const options = kind.materials
        ? names.filter((name) => kind.materials === "all" || name !== state.design.host)
        : kind.laws ? state.about.laws : kind.families ? state.about.families.map((family) => family.name) : kind.options;
      const is = kind.materials ? canonical(value) : value;
      const all = kind.optional || value === undefined ? ["", ...options] : options;
      field.replaceChildren(...[...new Set([...all, ...(is && !options.includes(is) ? [is] : [])])].map((name) => make("option", { value: name, selected: name === (is ?? "") }, name || "chosen")));
    };
  } else {
    field = make("input", { id, placeholder: kind.hint ?? "", "aria-describedby": why.id, inputMode: kind.whole || kind.number ? "decimal" : "text" });
    field.addEventListener("change", () => {
      const text = field.value.trim();
      if (!text) return kind.optional ? send(null) : show(state.keys[key]);
      send(kind.whole || kind.number ? Number(text) : text);
    });
    show = (value) => {
      set(field, value ?? "");
      const family = state.about.families.find((family) => family.name === state.keys["lens.family"]);
      if (key === "lens.stages" || key.startsWith("lens.parameters.")) row.hidden = !has(family, key);
      if (key === "lens.radius") row.hidden = !family?.radius;
      if (key === "lens.axis") row.hidden = !family?.has_axis;
    };
  }
  const row = make("div", { className: "control", "data-key": key }, make("label", { htmlFor: id }, label), field, why);
  controls.set(key, { row, why, show });
  return row;
}

/// Another family: what has no meaning for it is left out.
function family(name) {
  const next = state.about.families.find((family) => family.name === name);
  const edits = [{ key: "lens.family", value: name }];
  const leave = (key, when) => when && state.keys[key] !== undefined && edits.push({ key, value: null });
  leave("lens.others", !next.takes_others);
  leave("lens.radius", true);
  leave("lens.axis", !next.has_axis);
  for (const key of Object.keys(state.keys)) leave(key, (key === "lens.stages" || key.startsWith("lens.parameters.")) && !has(next, key));
  state.change(edits);
}

/// The name in the library of a name or alias.
function canonical(name) {
  const known = (state.design?.materials ?? []).find((material) => material.name === name || material.aliases.includes(name));
  return known?.name ?? name;
}

/// What is being typed is left alone.
function set(input, value) {
  if (document.activeElement !== input || input.value === "") input.value = String(value);
}

function fill() {
  for (const [key, { row, why, show }] of controls) {
    show(state.keys[key]);
    const error = state.error ?? (state.unreachable?.key ? state.unreachable : null);
    const wrong = error?.key === key || (error?.key && key.startsWith(`${error.key}.`) && key.endsWith(".rows"));
    row.classList.toggle("wrong", Boolean(wrong));
    why.textContent = wrong ? `${error.message.replace(/^[^ ]*: /, "")} ${error.help ?? ""}` : "";
  }
}

/// The file itself.
function textPanel() {
  const area = make("textarea", { rows: 18, spellcheck: false, "aria-label": "Design file" });
  const apply = make("button", { type: "button", disabled: true, onclick: () => state.replaceText(area.value) }, "Apply");
  area.addEventListener("input", () => (apply.disabled = area.value === state.text));
  const show = () => {
    if (document.activeElement === area) return;
    area.value = state.text;
    apply.disabled = true;
  };
  state.on("design", show);
  show();
  return make("details", {}, make("summary", {}, "Design file"), area, apply);
}
