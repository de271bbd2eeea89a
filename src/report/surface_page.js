// What stands under the pointer, and the nearest medium.
const svg = document.querySelector("svg"), here = document.getElementById("here");
const { digits, place, share, value, shownAt } = surfaceOf(data);
// The table's lines are those of the media, in their order.
const rows = [...document.querySelectorAll("section table tbody tr")];
const line = (name, text) => {
  const part = document.createElement("div"), bold = document.createElement("b");
  bold.textContent = text;
  part.append(name + ": ", bold);
  return part;
};
const point = (event) => {
  const box = svg.getBoundingClientRect(), view = svg.viewBox.baseVal;
  const at = [(event.clientX - box.left) / box.width * view.width, (event.clientY - box.top) / box.height * view.height];
  const shares = [(at[0] - data.corner[0]) / data.plot[0], 1 - (at[1] - data.corner[1]) / data.plot[1]];
  if (shares.some((part) => part < 0 || part > 1)) return;
  const [x, y] = [place(data.x, shares[0]), place(data.y, shares[1])], found = value(x, y);
  let near = null, least = 24;
  data.media.forEach((medium, k) => {
    const off = Math.hypot((share(data.x, medium.place[0]) - shares[0]) * data.plot[0], (share(data.y, medium.place[1]) - shares[1]) * data.plot[1]);
    if (off < least) { least = off; near = k; }
  });
  rows.forEach((row, k) => row.classList.toggle("near", k === near));
  const lines = [line(data.x.caption, shownAt(data.x, x)), line(data.y.caption, shownAt(data.y, y)), line(data.title, found === null ? "nothing can be said here" : digits(found / data.unit))];
  if (near !== null) lines.push(line("nearest medium", data.media[near].label + ", " + digits(data.media[near].value / data.unit)));
  here.replaceChildren(...lines);
};
svg.addEventListener("pointermove", point);
svg.addEventListener("pointerdown", point);
