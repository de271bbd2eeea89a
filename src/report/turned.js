// A crystal that can be turned: by dragging, by the arrow keys and by the two sliders; plus and minus make it larger or smaller.
(() => {
  const figure = document.getElementById("turned");
  const data = JSON.parse(document.getElementById("turned-data").textContent);
  const canvas = figure.querySelector("canvas"), pen = canvas.getContext("2d");
  const control = (name) => figure.querySelector(`[name=${name}]`);
  const [turn, tilt, cut, host, paint] = ["turn", "tilt", "cut", "host", "paint"].map(control);
  figure.querySelector(".still").hidden = true;
  figure.querySelector(".live").hidden = false;
  const n = data.x.length, shown = [];
  const far = Math.max(...data.x.map(Math.abs), ...data.y.map(Math.abs)), deep = Math.max(...data.z);
  let zoom = 1, wanted = false;
  cut.min = -far - 1; cut.max = far + 1; cut.step = 0.25; cut.value = cut.max;
  const draw = () => {
    wanted = false;
    const wide = canvas.clientWidth, high = canvas.clientHeight, dots = window.devicePixelRatio || 1;
    canvas.width = Math.round(wide * dots); canvas.height = Math.round(high * dots);
    pen.setTransform(dots, 0, 0, dots, 0, 0);
    pen.fillStyle = "#fff"; pen.fillRect(0, 0, wide, high);
    const [a, b] = [turn.value, tilt.value].map((degrees) => degrees * Math.PI / 180);
    const [ca, sa, cb, sb] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
    const scale = zoom * Math.min(wide, high) / (2 * Math.hypot(far, far, deep / 2) + 1);
    const energies = paint && paint.value === "energy", least = Number(cut.value);
    shown.length = 0;
    for (let k = 0; k < n; k += 1) {
      const free = data.material[k] > 0 || (energies && data.region[k] > 0);
      if (!(host.checked || free) || data.y[k] > least) continue;
      // Depth runs down; y towards the reader where nothing is turned.
      const z = data.z[k] - deep / 2, u = data.x[k] * ca - data.y[k] * sa, v = data.x[k] * sa + data.y[k] * ca;
      shown.push([v * cb - z * sb, wide / 2 + scale * u, high / 2 + scale * (z * cb + v * sb), k]);
    }
    // What is nearer comes later; v points away from the reader.
    shown.sort((p, q) => q[0] - p[0]);
    pen.lineWidth = Math.max(0.4, 0.05 * scale);
    for (const [, x, y, k] of shown) {
      pen.beginPath(); pen.arc(x, y, scale / 2, 0, 2 * Math.PI);
      pen.fillStyle = energies ? data.ramp[data.energy[k]] : data.inks[data.material[k]];
      pen.fill();
      pen.strokeStyle = ["rgba(0,0,0,.35)", "#d00000", "#0050d0"][data.region[k]];
      pen.stroke();
    }
  };
  const again = () => { if (!wanted) { wanted = true; requestAnimationFrame(draw); } };
  const moved = (slider, by) => { slider.value = Number(slider.value) + by; again(); };
  const around = (by) => { turn.value = ((Number(turn.value) + by + 540) % 360) - 180; again(); };
  figure.querySelectorAll("input, select").forEach((input) => input.addEventListener("input", again));
  canvas.addEventListener("keydown", (event) => {
    const acts = {
      ArrowLeft: () => around(-5), ArrowRight: () => around(5), ArrowUp: () => moved(tilt, 5), ArrowDown: () => moved(tilt, -5),
      "+": () => { zoom = Math.min(8, zoom * 1.15); again(); }, "-": () => { zoom = Math.max(0.3, zoom / 1.15); again(); },
    };
    const act = acts[event.key];
    if (act) { event.preventDefault(); act(); }
  });
  let from = null;
  canvas.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!from) return;
    around(0.5 * (event.clientX - from[0])); moved(tilt, 0.5 * (event.clientY - from[1]));
    from = [event.clientX, event.clientY];
  });
  ["pointerup", "pointercancel"].forEach((name) => canvas.addEventListener(name, () => { from = null; }));
  window.addEventListener("resize", again);
  again();
})();
