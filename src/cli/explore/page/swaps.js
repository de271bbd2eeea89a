// What exchanging single spheres does to C, as a map: asked for while it is shown, once the hand rests.

import { ask } from "./ask.js";
import { state } from "./state.js";

let of = null;
let found = null;

const here = ({ text, painted }) => of && of.text === text && of.painted === painted;

/// The changes, site by site, of what is on the page; null until they are known.
export const swaps = () => (here(state) && found && found.each.length === state.sites?.x.length ? found : null);

/// Asks for them, unless that is done.
export async function askSwaps(redraw) {
  if (here(state) || state.error || !state.layout) return;
  const { text, painted } = state;
  of = { text, painted };
  found = null;
  state.count(1);
  const answer = await ask("swaps", { text, layout: painted });
  state.count(-1);
  if (!here({ text, painted })) return;
  if (answer.cancelled || answer.error) {
    of = null;
    if (answer.error) state.fail(answer.error);
    return;
  }
  found = answer;
  redraw();
}
