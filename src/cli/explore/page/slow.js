// Maps that take seconds, what exchanging or changing single spheres does: asked for while they are shown, once the hand rests.

import { ask } from "./ask.js";
import { state } from "./state.js";

const of = {};
const found = {};

const here = (kind, { text, painted }) => of[kind] && of[kind].text === text && of[kind].painted === painted;
const sites = ({ each, sensitivities }) => (each ?? sensitivities[0].d_density).length;

/// What was found of what is on the page, of swaps or sensitivity; null until it is known.
export const known = (kind) => (here(kind, state) && found[kind] && sites(found[kind]) === state.sites?.x.length ? found[kind] : null);

/// Asks for it, unless that is done.
export async function askSlow(kind, redraw) {
  if (here(kind, state) || state.error || !state.layout) return;
  const { text, painted } = state;
  of[kind] = { text, painted };
  found[kind] = null;
  state.count(1);
  const answer = await ask(kind, { text, layout: painted });
  state.count(-1);
  if (!here(kind, { text, painted })) return;
  if (answer.cancelled || answer.error) {
    of[kind] = null;
    if (answer.error) state.fail(answer.error);
    return;
  }
  found[kind] = answer;
  redraw();
}
