// The same page in Firefox, driven by WebDriver BiDi, which it speaks itself.

import { spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { SMALL, assert, equal } from "./desk.mjs";

/// Busy machines are slow.
const PATIENCE = 120_000;

class Firefox {
  static async start() {
    const of = new Firefox();
    const { WebSocket } = createRequire(import.meta.url)(process.env.WEBSOCKET);
    of.profile = mkdtempSync(join(tmpdir(), "granulens-firefox-"));
    // Nothing of its own is fetched.
    writeFileSync(join(of.profile, "user.js"), ["app.update.enabled", "browser.safebrowsing.update.enabled", "network.captive-portal-service.enabled", "network.connectivity-service.enabled", "datareporting.policy.dataSubmissionEnabled", "browser.aboutHomeSnippets.updateUrl"].map((name) => `user_pref("${name}", false);\n`).join(""));
    of.process = spawn(process.env.FIREFOX, ["--headless", "--no-remote", "--profile", of.profile, "--remote-debugging-port", "0"], { env: { ...process.env, HOME: of.profile } });
    const address = await new Promise((done, fail) => {
      let said = "";
      const late = setTimeout(() => fail(new Error(`Firefox does not listen: ${said}`)), PATIENCE);
      of.process.stderr.on("data", (part) => {
        said += part;
        const found = /WebDriver BiDi listening on (ws:\S+)/.exec(said);
        if (found) clearTimeout(late), done(found[1]);
      });
      of.process.on("exit", () => fail(new Error(`Firefox ended: ${said}`)));
    });
    of.waiting = new Map();
    of.said = [];
    of.asked = [];
    of.socket = new WebSocket(`${address}/session`);
    await new Promise((done, fail) => of.socket.on("open", done).on("error", fail));
    of.socket.on("message", (text) => {
      const message = JSON.parse(text);
      if (message.method === "log.entryAdded") of.said.push(message.params);
      if (message.method === "network.beforeRequestSent") of.asked.push(message.params.request.url);
      const { done, fail } = of.waiting.get(message.id) ?? {};
      if (message.type === "success") done?.(message.result);
      if (message.type === "error") fail?.(new Error(`${message.error}: ${message.message}`));
    });
    await of.send("session.new", { capabilities: {} });
    await of.send("session.subscribe", { events: ["log.entryAdded", "network.beforeRequestSent"] });
    of.context = (await of.send("browsingContext.getTree", {})).contexts[0].context;
    return of;
  }

  send(method, params) {
    const id = (this.last = (this.last ?? 0) + 1);
    const answer = new Promise((done, fail) => this.waiting.set(id, { done, fail }));
    this.socket.send(JSON.stringify({ id, method, params }));
    return answer;
  }

  /// The value of an expression, a text or a number.
  async value(expression) {
    const answer = await this.send("script.evaluate", { expression, target: { context: this.context }, awaitPromise: true });
    if (answer.type === "exception") throw new Error(answer.exceptionDetails.text);
    return answer.result.value;
  }

  async until(expression) {
    const begun = performance.now();
    while (!(await this.value(`Boolean(${expression})`))) {
      if (performance.now() - begun > PATIENCE) throw new Error(`never: ${expression}`);
      await new Promise((done) => setTimeout(done, 100));
    }
  }

  async end() {
    this.socket?.close();
    const ended = new Promise((done) => this.process.on("close", done));
    this.process.kill("SIGTERM");
    await ended;
    rmSync(this.profile, { recursive: true, force: true });
  }
}

export async function the_page_works_in_firefox(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const firefox = await Firefox.start();
  try {
    await firefox.send("browsingContext.setViewport", { context: firefox.context, viewport: { width: 1280, height: 900 } });
    await firefox.send("browsingContext.navigate", { context: firefox.context, url: desk.address, wait: "complete" });
    await firefox.until("globalThis.granulens?.state.scenes.whole");
    // The numbers are those of the command line.
    const shown = await firefox.value("JSON.stringify(granulens.state.scenes.whole.numbers.arrangements.map((a) => a.scores))");
    const command = desk.granulens("compare", "small.toml", "--json");
    equal(JSON.parse(shown), JSON.parse(command.stdout).arrangements.map((a) => a.scores));
    // A key moves the focus, the lens follows.
    const before = await firefox.value("granulens.state.text");
    await firefox.value("document.querySelector('.region.focus').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true })), 1");
    await firefox.until(`granulens.state.text !== ${JSON.stringify(before)} && granulens.state.scenes.whole`);
    const { data } = await firefox.send("browsingContext.captureScreenshot", { context: firefox.context });
    const png = Buffer.from(data, "base64");
    assert(png.length > 30_000, `a picture of ${png.length} bytes shows nothing`);
    if (process.env.PICTURES) {
      mkdirSync(process.env.PICTURES, { recursive: true });
      writeFileSync(join(process.env.PICTURES, "firefox.png"), png);
    }
    equal(firefox.said.filter((entry) => ["error", "warn"].includes(entry.level)).map((entry) => entry.text), [], "on the console:");
    const { origin } = new URL(desk.address);
    equal(firefox.asked.filter((url) => url.startsWith("http") && !url.startsWith(origin)), [], "foreign requests:");
  } finally {
    await firefox.end();
  }
}
