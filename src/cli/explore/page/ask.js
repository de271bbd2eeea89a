// Questions to the program that serves this page.

/// This page, as the program tells tabs from each other: a reload or a copy of a tab is another one.
export const tab = crypto.randomUUID();

/// Asks, and gives the answer; what went wrong has the form of an answer too: `{ error: { kind, message, help } }`.
export async function ask(name, question) {
  try {
    return await (await send(name, question)).json();
  } catch {
    return gone();
  }
}

/// The same where the answer is bytes: `{ bytes }`.
export async function askBytes(name, question) {
  try {
    const answer = await send(name, question);
    if (answer.headers.get("Content-Type") === "application/json") return await answer.json();
    return { bytes: await answer.arrayBuffer() };
  } catch {
    return gone();
  }
}

const send = (name, question) => fetch(`./api/${name}`, {
  method: "POST",
  headers: { "Content-Type": "application/json" },
  body: JSON.stringify({ tab, ...question }),
});

const gone = () => ({ error: { kind: "gone", message: "granulens explore does not answer.", help: "Was it ended? Start it again and open the address that it prints; what you designed is kept in this tab until then." } });
