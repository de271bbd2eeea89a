// Lines over a quantity, as SVG: axes with round ticks, a legend, and the values under the pointer.

import { digits, make } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
/// Safe for the colour-blind on light and dark grounds, and told apart by their dashes.
export const LINES = ["#0b5394", "#c75000", "#12806a", "#a04f86", "#7a7f86", "#b58900"];
const DASHES = ["", "6 3", "2 3", "8 3 2 3", "1 2", "10 4"];

function svg(name, attributes, ...children) {
  const element = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/// Round numbers from low to high.
export function ticks(low, high, count = 5) {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((step) => step >= raw * 0.999);
  const list = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) list.push(k * step);
  return list;
}

const prefix = (high) => [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]].find(([scale]) => high >= scale) ?? [1e-9, "n"];

/// A chart: `lines` of `{ name, x, y, colour?, dashed? }`; values that are null leave a gap. `marker` is a place on x that is marked.
export function chart({ title, x, y, lines, height = 220, marker = null, zero = true, points = false, pick = null, label = null }) {
  const width = 460;
  const [left, right, top, bottom] = [52, 10, 24, 36];
  const numbers = (key) => lines.flatMap((line) => line[key]).filter((value) => value !== null && Number.isFinite(value));
  const span = (values, from0) => {
    let [low, high] = [Math.min(...values), Math.max(...values)];
    if (!values.length) [low, high] = [0, 1];
    if (from0) low = Math.min(low, 0);
    if (high <= low) high = low + (Math.abs(low) || 1);
    return [low, high];
  };
  const [x0, x1] = span(numbers("x"), false);
  const [y0, y1] = span(numbers("y"), zero);
  const px = (value) => left + ((value - x0) / (x1 - x0)) * (width - left - right);
  const py = (value) => height - bottom - ((value - y0) / (y1 - y0)) * (height - top - bottom);
  const scaled = (axis, high) => (axis.unit ? prefix(high) : [1, ""]);
  const [sx, ux] = scaled(x, Math.max(Math.abs(x0), Math.abs(x1)));
  const [sy, uy] = scaled(y, Math.max(Math.abs(y0), Math.abs(y1)));
  const short = (value) => digits(value, 3).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
  const named = (axis, unit) => (axis.unit ? `${axis.name} (${unit}${axis.unit})` : axis.name);
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label ?? title, class: "chart" });
  for (const tick of ticks(x0, x1)) {
    picture.append(svg("line", { x1: px(tick), x2: px(tick), y1: top, y2: height - bottom, class: "grid" }), svg("text", { x: px(tick), y: height - bottom + 13, "text-anchor": "middle" }, short(tick / sx)));
  }
  for (const tick of ticks(y0, y1, 4)) {
    picture.append(svg("line", { x1: left, x2: width - right, y1: py(tick), y2: py(tick), class: "grid" }), svg("text", { x: left - 5, y: py(tick) + 4, "text-anchor": "end" }, short(tick / sy)));
  }
  picture.append(svg("text", { x: left, y: 14, class: "title" }, title), svg("text", { x: width - right, y: height - 6, "text-anchor": "end" }, named(x, ux)), svg("text", { x: 12, y: top + (height - top - bottom) / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${top + (height - top - bottom) / 2})` }, named(y, uy)));
  lines.forEach((line, k) => {
    const colour = line.colour ?? LINES[k % LINES.length];
    if (points) {
      line.x.forEach((value, i) => {
        if (line.y[i] === null) return;
        const dot = svg("circle", { cx: px(value), cy: py(line.y[i]), r: line.radius ?? 3.5, fill: colour, "fill-opacity": 0.8, class: pick ? "pick" : "" });
        if (pick) {
          dot.setAttribute("tabindex", "0");
          dot.setAttribute("role", "button");
          dot.append(svg("title", {}, line.words?.[i] ?? `${short(value / sx)}, ${short(line.y[i] / sy)}`));
          dot.addEventListener("click", () => pick(line, i));
          dot.addEventListener("keydown", (event) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), pick(line, i)));
        }
        picture.append(dot);
      });
      return;
    }
    let path = "";
    line.x.forEach((value, i) => {
      const at = line.y[i];
      if (at === null || !Number.isFinite(at)) return;
      const gap = i === 0 || line.y[i - 1] === null;
      path += `${gap ? "M" : "L"}${px(value).toFixed(1)} ${py(at).toFixed(1)}`;
    });
    picture.append(svg("path", { d: path, fill: "none", stroke: colour, "stroke-width": 1.7, "stroke-dasharray": line.dash ?? DASHES[k % DASHES.length] }));
  });
  if (marker !== null) picture.append(svg("line", { x1: px(marker), x2: px(marker), y1: top, y2: height - bottom, class: "marker" }));
  const legend = lines.length > 1 || lines[0]?.name
    ? make("p", { className: "chart-legend" }, ...lines.filter((line) => line.name).map((line) => {
      const k = lines.indexOf(line);
      const sample = svg("svg", { viewBox: "0 0 26 8", width: 26, height: 8, "aria-hidden": "true" }, points ? svg("circle", { cx: 13, cy: 4, r: 3.5, fill: line.colour ?? LINES[k % LINES.length] }) : svg("line", { x1: 0, x2: 26, y1: 4, y2: 4, stroke: line.colour ?? LINES[k % LINES.length], "stroke-width": 2, "stroke-dasharray": line.dash ?? DASHES[k % DASHES.length] }));
      return make("span", {}, sample, ` ${line.name} `);
    }))
    : null;
  return make("figure", { className: "plot" }, picture, legend);
}
