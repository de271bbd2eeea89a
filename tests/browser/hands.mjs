// Painting, playing, ranking, the surface, studies.

import { SMALL, assert, equal, picture } from "./desk.mjs";

const site = (page, row, column) => page.evaluate(([row, column]) => {
  const { sites, design } = granulens.state;
  const i = sites.row.findIndex((of, k) => of === row && sites.column[k] === column);
  const canvas = document.getElementById("crystal");
  const box = canvas.getBoundingClientRect();
  const scale = Math.min(box.width / (2 * design.half_width + 1.4), 40);
  return [box.left + box.width / 2 + sites.x[i] * scale, box.top + (0.8 + sites.z[i]) * scale, i];
}, [row, column]);

export async function a_map_says_what_exchanging_a_sphere_does(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page({ height: 1200 });
  await desk.rest(page);
  await page.click("#paint");
  await page.click("#swaps");
  await page.waitForFunction(() => document.getElementById("legend").textContent.includes("chance"), null, { timeout: 120000 });
  await picture(page, "swaps");
  // The best exchange, painted, is worth at the same step what the map said.
  const answer = await page.evaluate(async () => {
    const { state } = granulens;
    const ask = (name, question) => fetch(`./api/${name}`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ tab: "t", text: state.text, ...question }) }).then((answer) => answer.json());
    const found = await ask("swaps", { layout: null });
    const best = found.each.reduce((a, b, i) => (b.change > found.each[a].change ? i : a), 0);
    const { palette } = state.lens;
    const materials = state.lens.materials.slice();
    materials[best] = palette.indexOf(found.each[best].material);
    const scene = await ask("scene", { layout: { palette, materials }, detail: "coarse" });
    return { count: found.each.length, sites: state.sites.x.length, drawn: found.contrast, change: found.each[best].change, contrast: scene.numbers.arrangements[0].scores.contrast };
  });
  equal(answer.count, answer.sites);
  assert(answer.change > 0 && Math.abs(answer.contrast / answer.drawn - 1 - answer.change) < 1e-9, JSON.stringify(answer));
}

export async function a_map_says_how_scores_change_with_every_sphere(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page({ height: 1200 });
  await desk.rest(page);
  await page.click("#sensitivity");
  await page.waitForFunction(() => document.getElementById("legend").textContent.includes("not linear"), null, { timeout: 120000 });
  await picture(page, "sensitivity");
  for (const map of ["focal_mean:secant_density", "focal_mean:d_youngs_modulus", "focal_mean:d_radius", "protected_mean:d_density", "protected_mean:secant_density"]) {
    await page.selectOption("#map", map);
    await page.waitForFunction((names) => document.getElementById("legend").textContent.startsWith(names), map.startsWith("focal") ? "F and G" : "P and Q");
  }
  await picture(page, "sensitivity-protected");
  await page.focus("#crystal");
  await page.keyboard.press("Home");
  await page.waitForFunction(() => /for 1 % more density P and Q .* \(derivative\), .* \(secant\): (not )?linear/.test(document.getElementById("sphere").textContent));
  // The numbers are the command's at the step for 1 %.
  desk.write("coarse.toml", `${SMALL}[run]\naccuracy = "1 %"\n`);
  equal(desk.granulens("design", "small.toml", "--out", "small.csv").status, 0);
  const command = desk.granulens("sensitivity", "small.csv", "--design", "coarse.toml", "--of", "focal_mean,protected_mean", "--json");
  equal(command.status, 0, command.stderr);
  const answer = await page.evaluate(async () => {
    const { state } = granulens;
    const asked = await fetch("./api/sensitivity", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ tab: "t", text: state.text, layout: null }) });
    return asked.json();
  });
  equal(answer.sensitivities, JSON.parse(command.stdout).sensitivities);
  await page.click("#sensitivity");
  equal(await page.inputValue("#map"), "materials");
}

export async function painting_by_hand_is_scored_as_the_command_line_does(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page({ height: 1200 });
  await desk.rest(page);
  const before = await page.evaluate(() => granulens.state.lens.materials);
  await page.click("#paint");
  await page.check('#paintbar input[value="brass-260"]');
  const [x, y, i] = await site(page, 14, 3);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y, { steps: 6 });
  await page.mouse.up();
  await page.waitForFunction((i) => granulens.state.painted?.materials[i] === 1, i);
  // A row with another material, which joins the palette.
  await page.check('#paintbar input[value="aluminium-2017"]');
  await page.selectOption("#brush-tool", "row");
  const [u, v, k] = await site(page, 20, 4);
  await page.mouse.click(u, v);
  await page.waitForFunction((k) => granulens.state.painted.palette[granulens.state.painted.materials[k]] === "aluminium-2017", k);
  await picture(page, "paint");
  await desk.rest(page);
  await page.click("#save");
  await page.click("#save-layout");
  await page.waitForFunction(() => document.querySelector("dialog").textContent.includes("saved as small.csv"));
  await page.keyboard.press("Escape");
  const command = desk.granulens("compare", "small.toml", "small.csv", "--json");
  equal(command.status, 0, command.stderr);
  const [shown, verdict] = await page.evaluate(() => {
    const { numbers } = granulens.state.scenes.whole;
    return [numbers.arrangements.map((a) => a.scores), numbers.verdict];
  });
  equal(shown, JSON.parse(command.stdout).arrangements.map((a) => a.scores));
  equal(verdict, JSON.parse(command.stdout).verdict);
  await page.click("#command");
  assert((await page.textContent("dialog")).includes("granulens compare small.toml small.csv"), await page.textContent("dialog"));
  await page.keyboard.press("Escape");
  // Two undos: the row, the stroke.
  await page.click("#undo");
  await page.click("#undo");
  await page.waitForFunction(() => !granulens.state.painted);
  equal(await page.evaluate(() => granulens.state.lens.materials), before);
  // By the keyboard alone.
  await page.focus("#crystal");
  await page.keyboard.press("Home");
  await page.keyboard.press("Space");
  await page.waitForFunction(() => granulens.state.painted && granulens.state.painted.materials[0] !== 0);
}

export async function the_wave_plays_beside_a_baseline(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  await desk.rest(page);
  await page.click("#tab-play");
  await page.waitForFunction(() => Number(document.getElementById("play-frame").max) > 100);
  await page.selectOption("#play-beside", "all-host");
  await page.waitForFunction(() => document.querySelectorAll("#play-views canvas").length === 2);
  await page.click("#play-go");
  await page.waitForFunction(() => Number(document.getElementById("play-frame").value) > 60);
  await page.click("#play-go");
  const at = await page.evaluate(() => document.getElementById("play-frame").value);
  await page.waitForTimeout(300);
  equal(await page.evaluate(() => document.getElementById("play-frame").value), at, "paused at");
  await page.focus("#play-views canvas");
  await page.keyboard.press("Home");
  for (let k = 0; k < 12; k += 1) await page.keyboard.press("ArrowDown");
  const words = await page.textContent("#play-words");
  assert(words.includes("Row 13") && words.includes("reached at") && words.includes("all-host"), words);
  const charts = await page.$$eval("#play-charts svg.chart", (all) => all.map((one) => one.getAttribute("aria-label")));
  assert(charts.length === 3 && charts[0].startsWith("Row 13") && charts[1].startsWith("Energy ledger"), charts.join());
  await picture(page, "play", { fullPage: true });
  const times = await page.evaluate(() => granulens.frames);
  const median = [...times].sort((a, b) => a - b)[times.length >> 1];
  console.log(`  a frame of two crystals of 16 rows a side is drawn in ${median.toFixed(1)} ms (median of ${times.length})`);
  if (process.env.BENCH) assert(median < 1000 / 60, "too slow for 60 frames a second");
}

export async function a_material_is_chosen_from_the_ranking(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  await page.click("#tab-rank");
  await page.waitForFunction(() => document.getElementById("rank-words").textContent.includes("--rank --simulate"));
  const shown = await page.$$eval("#rank-table tbody tr", (rows) => rows.map((row) => [...row.cells].slice(0, 3).map((cell) => cell.textContent)));
  const command = JSON.parse(desk.granulens("design", "small.toml", "--rank", "--simulate", "8", "--json").stdout).ranking;
  const can = command.filter((of) => !of.refused);
  equal(shown.map(([material, family]) => [material, family]), can.map((of) => [of.material, of.family]), "the order");
  assert(Math.abs(Number(shown[0][2]) / can[0].scores.contrast - 1) < 0.005, `C ${shown[0][2]} and ${can[0].scores.contrast}`);
  await picture(page, "rank");
  const [material, family] = shown[shown.length - 1];
  await page.locator("#rank-table tbody tr").last().locator("button").click();
  await page.waitForFunction(([material, family]) => granulens.state.lens?.palette[1] === material && granulens.state.lens.proposal.family === family, [material, family]);
  assert(!(await page.evaluate(() => document.getElementById("view-design").hidden)), "the design is shown");
}

/// What is ranked is what each design would give: rays and, of those that are simulated, C, G and Q; and "any" takes the best by rays.
export async function the_ranking_says_what_each_design_would(desk) {
  desk.write("small.toml", SMALL);
  const { ranking } = JSON.parse(desk.granulens("design", "small.toml", "--rank", "--simulate", "2", "--json").stdout);
  assert(ranking.length === 4 * 11, `${ranking.length} pairs of four materials and eleven families`);
  const of = (ranked) => SMALL.replace('"plano-convex"', `"${ranked.family}"`).replace('"brass-260"', `"${ranked.material}"`);
  let [lenses, refused] = [0, 0];
  for (const [k, ranked] of ranking.entries()) {
    desk.write(`${k}.toml`, of(ranked));
    const made = desk.granulens("design", `${k}.toml`, "--json");
    if (ranked.refused) {
      refused += 1;
      assert(made.status === 2 && made.stderr.length > 0, `${ranked.material} ${ranked.family} is refused`);
      continue;
    }
    lenses += 1;
    const { proposal } = JSON.parse(made.stdout);
    equal(ranked.fraction, [proposal.fraction, proposal.fraction_without], `${ranked.material} ${ranked.family}`);
    equal(ranked.spheres, proposal.piece.spheres);
    if (!ranked.scores) continue;
    const compared = JSON.parse(desk.granulens("compare", `${k}.toml`, "--json", "--forces", "1").stdout);
    for (const name of ["contrast", "focal_gain", "protection"]) equal(ranked.scores[name], compared.arrangements[0].scores[name], name);
  }
  assert(lenses > 5 && refused > 0 && ranking.filter((ranked) => ranked.scores || ranked.stop).length === 2, `${lenses} lenses`);
  desk.write("any.toml", SMALL.replace('"brass-260"', '"any"'));
  const any = desk.granulens("design", "any.toml");
  const best = ranking.filter((ranked) => ranked.family === "plano-convex" && !ranked.refused).sort((a, b) => b.fraction[0] - a.fraction[0])[0];
  assert(any.status === 0 && any.stderr.includes(`lens.material: ${best.material} is taken`), any.stderr);
  desk.write("none.toml", SMALL.replace('"brass-260"', "[]"));
  assert(desk.granulens("design", "none.toml").status === 2, "a list without materials");
}

export async function the_surface_answers_the_pointer(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  await page.click("#tab-surface");
  await page.waitForSelector("#surface-picture > svg");
  const box = await page.locator("#surface-picture > svg").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction(() => document.getElementById("surface-here").textContent.includes("Wave speed"));
  await picture(page, "surface", { fullPage: true });
  await page.locator("#surface-table button", { hasText: "al" }).first().click();
  await page.waitForFunction(() => granulens.state.keys["lens.material"] === "aluminium-2017");
}

const STUDY = `format = 1
design = "small.toml"
materials = ["stainless-440c", "brass-260"]
rows = [3, 12]
start = "lens"
seed = 1

[objective]
contrast = { maximise = 1 }
focal_gain = { maximise = 1 }

[[stage]]
method = "local"
evaluations = 160
`;

export async function a_study_runs_stops_goes_on_and_shows_its_layouts(desk) {
  desk.write("small.toml", SMALL);
  desk.write("search.toml", STUDY);
  await desk.explore("search.toml");
  const page = await desk.page();
  await page.waitForFunction(() => !document.getElementById("study-go").disabled);
  await page.click("#study-go");
  await page.waitForFunction(() => /^[1-9]\d* of 160/.test(document.getElementById("study-words").textContent));
  // A study that has just ended by itself has nothing to stop: its button is then without effect, and must not be waited for.
  await page.evaluate(() => document.getElementById("study-stop").click());
  await page.waitForFunction(() => /stopped|used up/.test(document.getElementById("study-words").textContent));
  await page.waitForFunction(() => !document.getElementById("study-go").disabled);
  await page.click("#study-go");
  await page.waitForFunction(() => document.getElementById("study-words").textContent.includes("used up"));
  const known = JSON.parse(desk.granulens("study", "show", "search.toml", "--json").stdout);
  assert(known.evaluations === 160, `${known.evaluations} evaluations`);
  await page.waitForFunction(() => document.getElementById("study-words").textContent.startsWith("160 of 160"));
  const best = await page.textContent("#study-best");
  assert(best.includes(`C ${known.best.contrast.toFixed(3)}`), `${best} and ${known.best.contrast}`);
  await picture(page, "study", { fullPage: true });
  await page.click("#study-take");
  await page.waitForFunction(() => granulens.state.painted);
  await desk.rest(page);
  const contrast = await page.evaluate(() => granulens.state.scenes.fine.numbers.arrangements[0].scores.contrast);
  assert(Math.abs(contrast / known.best.contrast - 1) < 0.02, `${contrast} and ${known.best.contrast}`);
}

export async function a_study_of_another_process_is_followed(desk) {
  desk.write("small.toml", SMALL);
  desk.write("search.toml", STUDY);
  const run = desk.granulens("study", "run", "search.toml", "--quiet");
  equal(run.status, 0, run.stderr);
  await desk.explore("small.toml");
  const page = await desk.page();
  await page.click("#tab-study");
  await page.waitForFunction(() => document.getElementById("study-words").textContent.startsWith("160 of 160"));
  await page.click("#view-study summary");
  await page.fill("#study-folders", "reports/search, reports/search");
  await page.click("#study-compare");
  await page.waitForFunction(() => document.getElementById("study-compared").textContent.includes("evaluations"));
  assert((await page.textContent("#study-compared")).includes("local"), await page.textContent("#study-compared"));
}
