// An explorer in a folder of its own, a page that shows it, and what a test may ask of them.

import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, mkdirSync, rmSync, writeFileSync, readFileSync, existsSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

const { chromium } = createRequire(import.meta.url)(process.env.PLAYWRIGHT);
const GRANULENS = process.env.GRANULENS;
/// Busy machines are slow; a test that hangs is to end all the same.
const PATIENCE = 90_000;

let browser;
export async function theBrowser() {
  browser ??= await chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  return browser;
}
export const closeBrowser = () => browser?.close();

export function assert(is, words) {
  if (!is) throw new Error(words);
}

export function equal(a, b, words = "") {
  const [x, y] = [a, b].map((value) => JSON.stringify(value));
  if (x !== y) throw new Error(`${words} ${x} is not ${y}`);
}

export class Desk {
  constructor() {
    this.folder = mkdtempSync(join(tmpdir(), "granulens-explore-"));
    this.faults = [];
    this.foreign = [];
  }

  write(name, text) {
    mkdirSync(join(this.folder, name, ".."), { recursive: true });
    writeFileSync(join(this.folder, name), text);
  }

  read(name) {
    return readFileSync(join(this.folder, name), "utf8");
  }

  holds(name) {
    return existsSync(join(this.folder, name));
  }

  /// Starts the explorer; gives its address.
  async explore(...args) {
    this.process = spawn(GRANULENS, ["explore", "--no-open", ...args], { cwd: this.folder });
    this.said = "";
    this.process.stderr.on("data", (text) => (this.said += text));
    this.ended = new Promise((done) => this.process.on("close", (code) => done(code)));
    this.address = await new Promise((done, fail) => {
      let text = "";
      this.process.stdout.on("data", (part) => {
        text += part;
        if (text.includes("\n")) done(text.trim());
      });
      this.process.on("exit", () => fail(new Error(`granulens explore ended: ${this.said}`)));
    });
    this.printed = this.address;
    return this.address;
  }

  /// A page on it. Anything that it says on its console, and any request that leaves this address, is a fault.
  async page({ width = 1280, height = 900, scheme = "light" } = {}) {
    const context = await (await theBrowser()).newContext({ viewport: { width, height }, colorScheme: scheme });
    this.contexts = [...(this.contexts ?? []), context];
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE);
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && this.faults.push(message.text()));
    page.on("pageerror", (error) => this.faults.push(String(error)));
    const { origin } = new URL(this.address);
    context.on("request", (request) => {
      if (!request.url().startsWith(origin) && !/^(data|blob):/.test(request.url())) this.foreign.push(request.url());
    });
    if (process.env.PAGE) await fromDisk(context, process.env.PAGE);
    await page.goto(this.address);
    await page.waitForFunction(() => globalThis.granulens?.state.design);
    return page;
  }

  /// Waits until the numbers on the page are those that the command line gives.
  async rest(page) {
    await page.waitForFunction(() => {
      const { state } = globalThis.granulens;
      return state.scenes.whole && state.scenes.whole.turn === state.turn;
    });
  }

  /// The command line in the same folder.
  granulens(...args) {
    const { status, stdout, stderr } = spawnSync(GRANULENS, args, { cwd: this.folder, encoding: "utf8" });
    return { status, stdout, stderr };
  }

  async end() {
    for (const context of this.contexts ?? []) await context.close();
    if (this.process && this.process.exitCode === null) {
      this.process.kill("SIGINT");
      await this.ended;
    }
    rmSync(this.folder, { recursive: true, force: true });
    equal(this.faults, [], "on the console:");
    equal(this.foreign, [], "foreign requests:");
  }
}

/// The page's files from a folder in place of those in the program: for work on them, without a build.
async function fromDisk(context, folder) {
  const kinds = { js: "text/javascript", css: "text/css", svg: "image/svg+xml", html: "text/html" };
  await context.route(/\/[0-9a-f]{32}\/([\w-]+\.\w+)?$/, (route) => {
    const name = new URL(route.request().url()).pathname.split("/").pop() || "index.html";
    const path = join(folder, name);
    return existsSync(path) ? route.fulfill({ body: readFileSync(path), contentType: kinds[name.split(".").pop()] }) : route.fallback();
  });
}

/// A screenshot, where they are kept.
export async function picture(page, name, options = {}) {
  if (!process.env.PICTURES) return;
  mkdirSync(process.env.PICTURES, { recursive: true });
  await page.screenshot({ path: join(process.env.PICTURES, `${name}.png`), ...options });
}

/// A small crystal: quick on any machine.
export const SMALL = `# small, for tests
format = 1
name = "small"

[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 24
half_width = 8
sides = "mirror"
host = "stainless-440c"   # the host
law = "consistent"

[impact]
kind = "force-pulse"
force = "26 kN"
duration = "20 us"

[target]
focus = { rows = [16, 18], x = ["0 D", "1.5 D"] }
protect = { rows = [16, 18], x = ["6 D", "8 D"] }

[lens]
family = "plano-convex"
material = "brass-260"
rows = [3, 13]

[compare]
seeds = 2
`;
