// The crystal on a canvas: both halves, spheres in true proportion, letters where there is room, and lines above them.

/// A map from the crystal's coordinates, in diameters from the axis and below row 1, to the canvas.
export class Crystal {
  constructor(canvas, ink) {
    this.canvas = canvas;
    this.ink = ink;
    this.half = 1;
    this.depth = 1;
    this.sites = null;
  }

  /// Takes up a crystal: sites, half width and depth in diameters.
  take(sites, half, rows, spacing) {
    this.sites = sites;
    this.half = half;
    this.spacing = spacing;
    this.depth = (rows - 1) * spacing;
    this.rows = rows;
    this.fit();
  }

  /// Fits the canvas to the place that it has on the page; whether something changed.
  fit() {
    const width = this.canvas.parentElement.clientWidth;
    if (!width || !this.sites) return false;
    const scale = Math.min(width / (2 * this.half + 1.4), 40);
    const [w, h] = [width, (this.depth + 1.6) * scale];
    const dots = window.devicePixelRatio || 1;
    const changed = this.canvas.width !== Math.round(w * dots) || this.canvas.height !== Math.round(h * dots);
    if (changed) {
      this.canvas.width = Math.round(w * dots);
      this.canvas.height = Math.round(h * dots);
      this.canvas.style.height = `${h}px`;
    }
    this.scale = scale;
    this.dots = dots;
    this.left = w / 2;
    this.top = 0.8 * scale;
    return changed;
  }

  place(x, z) {
    return [this.left + x * this.scale, this.top + z * this.scale];
  }

  /// Where a point of the canvas (CSS px) lies in the crystal.
  back(px, py) {
    return [(px - this.left) / this.scale, (py - this.top) / this.scale];
  }

  /// The site nearest to a point of the crystal, of either half; -1 outside.
  at(x, z) {
    const row = Math.round(z / this.spacing) + 1;
    let best = -1;
    let least = 0.34;
    for (const near of [row - 1, row, row + 1]) {
      const range = this.rowRange(near);
      if (!range) continue;
      for (let i = range[0]; i < range[1]; i += 1) {
        const off = (this.sites.x[i] - Math.abs(x)) ** 2 + (this.sites.z[i] - z) ** 2;
        if (off < least) [best, least] = [i, off];
      }
    }
    return best;
  }

  /// The site that an arrow key leads to from one; -1 for none, null where the key says nothing.
  step(from, key) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [-0.5, -1], ArrowDown: [0.5, 1], Home: null, Escape: null };
    if (!(key in steps) || !this.sites) return null;
    if (key === "Escape") return -1;
    if (from < 0 || key === "Home") return 0;
    const [dx, dr] = steps[key];
    const { x, row } = this.sites;
    const range = this.rowRange(row[from] + dr);
    if (!range) return from;
    let best = range[0];
    for (let i = range[0]; i < range[1]; i += 1) {
      if (Math.abs(x[i] - x[from] - dx) < Math.abs(x[best] - x[from] - dx)) best = i;
    }
    return best;
  }

  /// First and one past the last index of a row.
  rowRange(row) {
    if (this.known !== this.sites) {
      this.known = this.sites;
      this.ranges = new Map();
      this.sites.row.forEach((row, i) => {
        const range = this.ranges.get(row);
        if (range) range[1] = i + 1;
        else this.ranges.set(row, [i, i + 1]);
      });
    }
    return this.ranges.get(row) ?? null;
  }

  /// A sphere of a colour, drawn once: what moves is made of copies, which cost a tenth of circles.
  sprite(colour, radius) {
    const key = `${colour} ${radius} ${this.dots}`;
    this.sprites ??= new Map();
    const known = this.sprites.get(key);
    if (known) return known;
    if (this.sprites.size > 500) this.sprites.clear();
    const sprite = document.createElement("canvas");
    sprite.width = sprite.height = Math.ceil(2 * (radius + 1) * this.dots);
    const ctx = sprite.getContext("2d");
    ctx.setTransform(this.dots, 0, 0, this.dots, sprite.width / 2, sprite.height / 2);
    ctx.fillStyle = colour;
    ctx.beginPath();
    ctx.arc(0, 0, radius, 0, 2 * Math.PI);
    ctx.fill();
    this.sprites.set(key, sprite);
    return sprite;
  }

  /// Draws: `fill(i)` gives a sphere's colour, `letter(i)` what stands on it and in which colour, or null; `quick` while something moves.
  draw({ fill, letter = null, chosen = -1, lines = [], quick = false }) {
    if (!this.sites || !this.scale) return;
    const ctx = this.canvas.getContext("2d");
    ctx.setTransform(this.dots, 0, 0, this.dots, 0, 0);
    const [w, h] = [this.canvas.width / this.dots, this.canvas.height / this.dots];
    ctx.clearRect(0, 0, w, h);
    const { x, z } = this.sites;
    const radius = 0.5 * this.scale;
    // One path a colour: a canvas changes its colour slower than it draws a circle.
    const byColour = new Map();
    for (let i = 0; i < x.length; i += 1) {
      const colour = fill(i);
      const list = byColour.get(colour);
      if (list) list.push(i);
      else byColour.set(colour, [i]);
    }
    const drawn = Math.max(radius - (radius > 5 ? 0.4 : 0), 0.7);
    for (const [colour, list] of quick ? byColour : []) {
      const sprite = this.sprite(colour, drawn);
      const half = sprite.width / 2 / this.dots;
      for (const i of list) {
        for (const side of x[i] > 1e-9 ? [1, -1] : [1]) {
          const [px, py] = this.place(side * x[i], z[i]);
          ctx.drawImage(sprite, px - half, py - half, 2 * half, 2 * half);
        }
      }
    }
    for (const [colour, list] of quick ? [] : byColour) {
      ctx.fillStyle = colour;
      ctx.beginPath();
      for (const i of list) {
        for (const side of x[i] > 1e-9 ? [1, -1] : [1]) {
          const [px, py] = this.place(side * x[i], z[i]);
          ctx.moveTo(px + drawn, py);
          ctx.arc(px, py, drawn, 0, 2 * Math.PI);
        }
      }
      ctx.fill();
      if (radius > 4) {
        ctx.strokeStyle = "rgba(0,0,0,.28)";
        ctx.lineWidth = 0.6;
        ctx.stroke();
      }
    }
    if (letter && radius >= 4.4) {
      ctx.font = `600 ${Math.min(radius * 1.25, 12)}px Helvetica, Arial, sans-serif`;
      ctx.textAlign = "center";
      ctx.textBaseline = "middle";
      for (let i = 0; i < x.length; i += 1) {
        const [text, colour] = letter(i) ?? [];
        if (!text) continue;
        ctx.fillStyle = colour;
        for (const side of x[i] > 1e-9 ? [1, -1] : [1]) ctx.fillText(text, ...this.place(side * x[i], z[i] + 0.03));
      }
    }
    this.clip(ctx);
    for (const { points, colour, width, dash = [], halo = 0, alpha = 1 } of lines) this.line(ctx, points, colour, width, dash, halo, alpha);
    ctx.restore();
    if (chosen >= 0) {
      for (const side of [1, -1]) {
        const [px, py] = this.place(side * x[chosen], z[chosen]);
        for (const [colour, width] of [["#fff", 4], ["#000", 2]]) {
          ctx.strokeStyle = colour;
          ctx.lineWidth = width;
          ctx.beginPath();
          ctx.arc(px, py, radius + 1, 0, 2 * Math.PI);
          ctx.stroke();
        }
      }
    }
  }

  clip(ctx) {
    ctx.save();
    ctx.beginPath();
    const [left, top] = this.place(-this.half - 0.5, -0.6);
    const [right, bottom] = this.place(this.half + 0.5, this.depth + 0.6);
    ctx.rect(left, top, right - left, bottom - top);
    ctx.clip();
  }

  /// A line and its mirror image.
  line(ctx, points, colour, width, dash, halo, alpha) {
    if (points.length < 2) return;
    ctx.globalAlpha = alpha;
    ctx.setLineDash(dash);
    ctx.lineJoin = "round";
    for (const side of [1, -1]) {
      ctx.beginPath();
      points.forEach(([x, z], k) => ctx[k ? "lineTo" : "moveTo"](...this.place(side * x, z)));
      if (halo) {
        ctx.strokeStyle = "#fff";
        ctx.lineWidth = width + halo;
        ctx.stroke();
      }
      ctx.strokeStyle = colour;
      ctx.lineWidth = width;
      ctx.stroke();
    }
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }
}

/// From values to colours of a table: linear from zero, or by the logarithm over three decades.
export class Scale {
  constructor(colours, low, high, logarithmic = false) {
    Object.assign(this, { colours, low, high: high > low ? high : low + 1, logarithmic });
  }

  colour(value) {
    if (value === null || !Number.isFinite(value)) return "#ffffff";
    const part = this.logarithmic
      ? value > 0 ? Math.log(value / this.low) / Math.log(this.high / this.low) : 0
      : (value - this.low) / (this.high - this.low);
    const count = this.colours.length;
    return this.colours[Math.min(count - 1, Math.max(0, Math.floor(part * count)))];
  }
}

/// The value below which a share of the positive ones lie.
export function quantile(values, share) {
  const sorted = values.filter((value) => Number.isFinite(value) && value > 0).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : 1;
}
