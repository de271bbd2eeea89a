// Who may ask, and how it ends.

import { request } from "node:http";
import { SMALL, assert, equal } from "./desk.mjs";

/// One request, as any program could send it.
const send = (address, { path, method = "POST", headers = {}, body = "{}" }) =>
  new Promise((done, fail) => {
    const { hostname, port, pathname } = new URL(address);
    const asked = request({ hostname, port, path: path ?? `${pathname}api/open`, method, headers: { "Content-Type": "application/json", ...headers } }, (answer) => {
      let text = "";
      answer.on("data", (part) => (text += part));
      answer.on("end", () => done({ status: answer.statusCode, headers: answer.headers, text }));
    });
    asked.on("error", fail);
    asked.end(method === "GET" ? undefined : body);
  });

export async function only_the_own_page_is_answered(desk) {
  desk.write("small.toml", SMALL);
  const address = await desk.explore("small.toml");
  assert(/^http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\/$/.test(address), `the address is ${address}`);
  const { host, pathname } = new URL(address);
  const status = async (asked) => (await send(address, asked)).status;
  equal(await status({}), 200, "the own page");
  equal(await status({ headers: { Host: "evil.example" } }), 403, "another name of this machine");
  equal(await status({ headers: { Origin: "http://evil.example" } }), 403, "another page");
  equal(await status({ headers: { Origin: `http://${host}` } }), 200, "the own origin");
  equal(await status({ headers: { "Sec-Fetch-Site": "cross-site" } }), 403, "across sites");
  equal(await status({ headers: { "Content-Type": "text/plain" } }), 415, "a form");
  equal(await status({ path: "/api/open" }), 404, "without the token");
  equal(await status({ path: `${pathname.slice(0, -2)}x/api/open` }), 404, "with another token");
  equal(await status({ path: `${pathname}../Cargo.toml`, method: "GET" }), 404, "a file");
  equal(await status({ path: `${pathname}api/nothing` }), 404, "another question");
  equal(await status({ body: "x".repeat((4 << 20) + 1) }), 413, "a long body");
  const page = await send(address, { path: pathname, method: "GET" });
  assert(page.headers["content-security-policy"].includes("default-src 'none'") && page.headers["referrer-policy"] === "no-referrer", "the headers of the page");
  const lines = JSON.parse((await send(address, { path: `${pathname}api/scene`, body: "{}" })).text);
  equal(lines.error.kind, "input", "a question without words is answered");
}

export async function nothing_is_written_elsewhere_or_in_the_place_of_a_users_file(desk) {
  desk.write("small.toml", SMALL);
  desk.write("mine.toml", "# mine\n");
  const address = await desk.explore("small.toml");
  const save = async (path) => {
    const body = JSON.stringify({ what: "design", path, text: `${SMALL}# changed\n`, tab: "a" });
    return JSON.parse((await send(address, { path: `${new URL(address).pathname}api/save`, body })).text);
  };
  equal((await save("new.toml")).saved, "new.toml");
  equal(desk.read("new.toml"), `${SMALL}# changed\n`, "the text");
  for (const path of ["../out.toml", "/tmp/out.toml", "mine.toml", "small.toml", ""]) {
    assert((await save(path)).error, `${path} was written`);
  }
  equal(desk.read("mine.toml"), "# mine\n", "a user's file");
  equal(desk.read("small.toml"), SMALL, "what was opened");
  equal((await save("new.toml")).saved, "new.toml", "its own is replaced");
}

export async function ctrl_c_ends_it_cleanly(desk) {
  desk.write("small.toml", SMALL);
  const address = await desk.explore("small.toml");
  const body = JSON.stringify({ text: SMALL, detail: "whole", tab: "a" });
  const busy = send(address, { path: `${new URL(address).pathname}api/scene`, body }).catch(() => null);
  await new Promise((done) => setTimeout(done, 300));
  desk.process.kill("SIGINT");
  equal(await desk.ended, 0, "the exit code");
  await busy;
  assert(desk.said.includes("ended"), desk.said);
}
