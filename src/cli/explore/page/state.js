// What is on the page: the text of the design file, what the program makes of it, and the layout where it is painted.

import { ask } from "./ask.js";

const KEPT = "granulens";

/// How long the hand must rest before the fine numbers are asked for (ms).
const STILL = 180;

class State extends EventTarget {
  text = "";
  keys = {};
  design = null; // the last one that could be read
  lens = null;
  unreachable = null;
  error = null; // what is wrong with the text
  sites = null;
  painted = null; // { palette, materials }, in place of the proposed lens
  scene = null; // the last simulation
  scenes = {}; // the last one of each detail, for the text that it belongs to
  about = null; // what the program said at the start
  past = [];
  future = [];
  busy = 0;

  emit(name) {
    this.dispatchEvent(new Event(name));
  }

  on(names, then) {
    for (const name of names.split(" ")) this.addEventListener(name, then);
  }

  // ---- beginning and keeping

  async begin() {
    this.about = await ask("open", {});
    if (this.about.error) return this.fail(this.about.error);
    const kept = this.kept();
    this.text = kept?.text ?? this.about.text;
    this.painted = kept ? kept.painted : this.about.layout;
    await this.look([]);
  }

  kept() {
    try {
      const kept = JSON.parse(sessionStorage.getItem(KEPT));
      return kept && kept.file === this.about.file && kept.first === this.about.text ? kept : null;
    } catch {
      return null;
    }
  }

  keep() {
    try {
      const { text, painted, about } = this;
      sessionStorage.setItem(KEPT, JSON.stringify({ text, painted, file: about.file, first: about.text }));
    } catch {
      // A tab without storage forgets at a reload.
    }
  }

  // ---- undo

  remember() {
    const last = this.past.at(-1);
    if (last && last.text === this.text && last.painted === this.painted) return;
    this.past.push({ text: this.text, painted: this.painted });
    if (this.past.length > 300) this.past.shift();
    this.future = [];
    this.emit("history");
  }

  async step(from, to) {
    const next = from.pop();
    if (!next) return;
    to.push({ text: this.text, painted: this.painted });
    ({ text: this.text, painted: this.painted } = next);
    this.emit("history");
    await this.look([]);
  }

  undo = () => this.step(this.past, this.future);
  redo = () => this.step(this.future, this.past);

  // ---- changes of the design

  /// Changes keys; `{ key, value }` each, null to leave the key out. `moving` while a hand is on it: then one undo takes back all.
  change(edits, moving = false) {
    if (!moving && !this.moving) this.remember();
    return this.look(edits);
  }

  /// Begins and ends a move of the hand.
  grasp() {
    this.remember();
    this.moving = true;
  }

  release() {
    this.moving = false;
    const last = this.past.at(-1);
    if (last && last.text === this.text && last.painted === this.painted) {
      this.past.pop();
      this.emit("history");
    }
    this.rest();
  }

  replaceText(text) {
    this.remember();
    this.text = text;
    return this.look([]);
  }

  /// Asks what the text means with some changes. While one question is open the next waits; of waiting ones the last word of each key
  /// counts.
  async look(edits) {
    this.waiting = new Map([...(this.waiting ?? []), ...edits.map((edit) => [edit.key, edit])]);
    this.since ??= performance.now();
    if (this.looking) return this.looking;
    this.looking = (async () => {
      while (this.waiting) {
        const edits = [...this.waiting.values()];
        const since = this.since;
        this.waiting = null;
        this.since = null;
        const { text } = this;
        const answer = await ask("design", { text, edits, known: this.design?.crystal ?? "" });
        // An undo meanwhile has the last word.
        if (text === this.text) this.heard(answer, since);
        else this.waiting ??= new Map();
      }
      this.looking = null;
    })();
    return this.looking;
  }

  heard(answer, since) {
    if (answer.error && !answer.text) return this.fail(answer.error);
    this.text = answer.text;
    this.keys = answer.keys ?? this.keys;
    this.error = answer.error ?? null;
    if (answer.design) {
      this.design = answer.design;
      // Lengths over a diameter have the digits of rounding, which no file is to hold.
      for (const region of [...answer.design.foci, answer.design.protect]) region.x = region.x.map((x) => Math.round(x * 1e6) / 1e6);
      if (answer.design.sites) this.sites = answer.design.sites;
      // What was painted on another crystal is gone; undo brings both back.
      if (this.painted && this.painted.materials.length !== this.design.spheres) this.painted = null;
      this.lens = answer.lens ?? null;
      this.unreachable = answer.unreachable ?? null;
    }
    this.keep();
    this.since_drawn = since;
    this.ms = answer.ms;
    this.emit("design");
    this.moved();
  }

  fail(error) {
    this.failure = error;
    this.emit("failure");
  }

  // ---- painting

  /// The layout that is shown: the painted one or that of the proposed lens.
  get layout() {
    return this.painted ?? this.lens;
  }

  paint(materials, palette = this.layout.palette) {
    this.painted = { palette, materials };
    this.keep();
    this.emit("painted");
    this.moved();
  }

  forgetPaint() {
    this.remember();
    this.painted = null;
    this.keep();
    this.emit("painted");
    this.moved();
  }

  // ---- simulation

  /// Something has changed: coarse numbers at once, fine ones when the hand rests.
  moved() {
    this.turn = (this.turn ?? 0) + 1;
    this.changed = performance.now();
    this.scenes = {};
    this.emit("stale");
    if (this.error || !this.layout) return;
    this.simulate("coarse");
    if (!this.moving) this.rest();
  }

  rest() {
    clearTimeout(this.resting);
    const turn = this.turn;
    this.resting = setTimeout(async () => {
      if (this.moving || turn !== this.turn || this.error || !this.layout) return;
      await this.coarse;
      if (this.moving || turn !== this.turn) return;
      await this.simulate("fine");
      if (turn === this.turn && !this.moving) await this.simulate("whole");
    }, STILL);
  }

  /// A coarse simulation that is under way is waited for, so that a hand that never rests still sees numbers; finer ones give way.
  simulate(detail) {
    if (detail !== "coarse") return this.run(detail);
    if (this.coarse) {
      this.again = true;
      return this.coarse;
    }
    this.coarse = (async () => {
      do {
        this.again = false;
        await this.run("coarse");
      } while (this.again && !this.error && this.layout);
      this.coarse = null;
    })();
    return this.coarse;
  }

  async run(detail) {
    const { turn, changed, text, painted: layout } = this;
    const asked = performance.now();
    this.count(1);
    const answer = await ask("scene", { text, layout, detail });
    this.count(-1);
    if (answer.cancelled) return;
    if (answer.error) {
      if (turn === this.turn) this.fail(answer.error);
      return;
    }
    // Of a design that has changed meanwhile only the coarse picture is shown, as an old one.
    if (turn !== this.turn && detail !== "coarse") return;
    this.scene = { ...answer, detail, turn, took: performance.now() - asked, since: performance.now() - changed };
    if (turn === this.turn) this.scenes[detail] = this.scene;
    this.failure = null;
    this.emit("scene");
  }

  count(change) {
    this.busy += change;
    this.emit("busy");
  }
}

export const state = new State();
