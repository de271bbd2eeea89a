// Runs the tests: every export of the files below, or those that are named.

import * as design from "./design.mjs";
import * as firefox from "./firefox.mjs";
import * as hands from "./hands.mjs";
import * as safety from "./safety.mjs";
import { Desk, closeBrowser } from "./desk.mjs";

const wanted = process.argv.slice(2);
const all = Object.entries({ ...safety, ...design, ...hands, ...(process.env.FIREFOX ? firefox : {}) });
const unknown = wanted.filter((name) => !all.some(([known]) => known === name));
if (unknown.length) {
  console.error(`no such test: ${unknown.join(", ")}; there are ${all.map(([name]) => name).join(", ")}`);
  process.exit(2);
}
let failed = 0;
for (const [name, test] of all.filter(([name]) => !wanted.length || wanted.includes(name))) {
  const desk = new Desk();
  const begun = performance.now();
  let words = "passed";
  try {
    await test(desk);
  } catch (error) {
    words = `FAILED: ${error.stack ?? error}`;
  }
  try {
    await desk.end();
  } catch (error) {
    words = words === "passed" ? `FAILED: ${error.message}` : `${words}\n  and ${error.message}`;
  }
  if (words !== "passed") failed += 1;
  console.log(`${name} ... ${words} (${((performance.now() - begun) / 1e3).toFixed(1)} s)`);
}
await closeBrowser();
process.exit(failed ? 1 : 0);
