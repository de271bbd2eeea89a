// The design surface: which speed which materials give, under the pointer and by the keyboard.

import { ask } from "./ask.js";
import { state } from "./state.js";
import { surfaceOf } from "./surface-of.js";
import { make } from "./words.js";

const at = (name) => document.getElementById(`surface-${name}`);
let of = null;

export function openSurface(show) {
  at("value").onchange = () => load(show);
  if (of !== state.text) load(show);
}

async function load(show) {
  const { text } = state;
  const value = at("value").value || "speed";
  const answer = await ask("surface", { text, value });
  if (answer.error) {
    at("here").textContent = `${answer.error.message} ${answer.error.help ?? ""}`;
    return;
  }
  of = text;
  if (!at("value").options.length) at("value").append(...answer.values.map((name) => make("option", { value: name, selected: name === value }, name)));
  draw(answer, show);
}

function draw({ svg: picture, data, own, names }, show) {
  const box = at("picture");
  box.innerHTML = picture;
  const svg = box.querySelector("svg");
  const { digits, place, share, value, shownAt } = surfaceOf(data);
  const at2d = (medium) => [share(data.x, medium.place[0]), share(data.y, medium.place[1])];
  const known = new Map(names);
  const take = (medium) => {
    const name = known.get(medium.label);
    if (!name || name === state.design.host) return;
    state.painted = null;
    state.change([{ key: "lens.material", value: name }]);
    show("design");
  };
  const rows = data.media.map((medium) => {
    const isOwn = own.includes(medium.label) && medium.kind === "uniform";
    const label = known.has(medium.label) && known.get(medium.label) !== state.design.host
      ? make("button", { type: "button", className: "plain", title: "make the lens of it", onclick: () => take(medium) }, medium.label)
      : medium.label;
    return make("tr", { className: isOwn ? "current" : "", tabIndex: -1 }, make("td", {}, label), make("td", {}, isOwn ? `${medium.kind}, of the design` : medium.kind), make("td", {}, digits(medium.place[0] / data.x.unit)), make("td", {}, digits(medium.place[1] / data.y.unit)), make("td", {}, digits(medium.value / data.unit)));
  });
  at("table").replaceChildren(make("thead", {}, make("tr", {}, ...["medium", "", data.x.caption, data.y.caption, data.title].map((text) => make("th", { scope: "col" }, text)))), make("tbody", {}, ...rows));
  // The materials of the design are ringed.
  for (const medium of data.media.filter((medium) => own.includes(medium.label) && medium.kind === "uniform")) {
    const [x, y] = at2d(medium);
    const ring = document.createElementNS("http://www.w3.org/2000/svg", "circle");
    for (const [key, text] of Object.entries({ cx: data.corner[0] + x * data.plot[0], cy: data.corner[1] + (1 - y) * data.plot[1], r: 11, fill: "none", stroke: "#111", "stroke-width": 2.5 })) ring.setAttribute(key, text);
    const halo = ring.cloneNode();
    halo.setAttribute("stroke", "#fff");
    halo.setAttribute("stroke-width", 5);
    svg.append(halo, ring);
  }
  const tell = (x, y, near) => {
    const found = value(x, y);
    const parts = [`${data.x.caption}: ${shownAt(data.x, x)}`, `${data.y.caption}: ${shownAt(data.y, y)}`, `${data.title}: ${found === null ? "nothing can be said here" : digits(found / data.unit)}`];
    if (near !== null) parts.push(`nearest medium: ${data.media[near].label}, ${digits(data.media[near].value / data.unit)}`);
    at("here").textContent = parts.join("; ");
    rows.forEach((row, k) => row.classList.toggle("near", k === near));
  };
  const nearest = (shares) => {
    let near = null;
    let least = 24;
    data.media.forEach((medium, k) => {
      const [x, y] = at2d(medium);
      const off = Math.hypot((x - shares[0]) * data.plot[0], (y - shares[1]) * data.plot[1]);
      if (off < least) [near, least] = [k, off];
    });
    return near;
  };
  const sharesAt = (event) => {
    const place = svg.getBoundingClientRect();
    const view = svg.viewBox.baseVal;
    const point = [((event.clientX - place.left) / place.width) * view.width, ((event.clientY - place.top) / place.height) * view.height];
    return [(point[0] - data.corner[0]) / data.plot[0], 1 - (point[1] - data.corner[1]) / data.plot[1]];
  };
  svg.addEventListener("pointermove", (event) => {
    const shares = sharesAt(event);
    if (shares.some((part) => part < 0 || part > 1)) return;
    tell(place(data.x, shares[0]), place(data.y, shares[1]), nearest(shares));
  });
  svg.addEventListener("click", (event) => {
    const near = nearest(sharesAt(event));
    if (near !== null) take(data.media[near]);
  });
}
