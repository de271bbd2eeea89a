// The design tab: drag, keyboard, controls, save, reload, narrow screens.

import { SMALL, assert, equal, picture } from "./desk.mjs";

const focusOf = (page) => page.evaluate(() => granulens.state.design.foci[0]);
const centre = async (element) => {
  const box = await element.boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
};
/// By so many diameters and rows.
async function drag(page, selector, [dx, rows], steps = 12) {
  const [x, y] = await centre(page.locator(selector));
  const { scale, spacing } = await page.evaluate(() => ({ scale: document.getElementById("crystal").clientWidth / (2 * granulens.state.design.half_width + 1.4), spacing: granulens.state.design.row_spacing }));
  const unit = Math.min(scale, 40);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx * unit, y + rows * spacing * unit, { steps });
  await page.mouse.up();
}

export async function dragging_the_focus_changes_the_file_and_the_lens(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  const before = await page.evaluate(() => granulens.state.lens.materials.join(""));
  await drag(page, '[data-key="target.focus"]', [1, 2]);
  await page.waitForFunction(() => granulens.state.design.foci[0].rows[0] === 18);
  equal(await focusOf(page), { rows: [18, 20], x: [1, 2.5] });
  const { text, lens } = await page.evaluate(() => ({ text: granulens.state.text, lens: granulens.state.lens?.materials.join("") }));
  assert(text.includes('focus = { rows = [18, 20], x = ["1 D", "2.5 D"] }') && text.includes("# the host"), text);
  assert(lens !== before, "the lens has not followed");
  equal(desk.read("small.toml"), SMALL, "the user's file is left alone");
  await page.keyboard.press("Control+z");
  await page.waitForFunction(() => granulens.state.design.foci[0].rows[0] === 16);
  equal(await page.evaluate(() => granulens.state.text), SMALL, "one undo takes back the whole drag");
}

export async function the_numbers_are_those_of_the_command_line(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  await desk.rest(page);
  const { status, stdout, stderr } = desk.granulens("compare", "small.toml", "--json");
  equal(status, 0, stderr);
  const command = JSON.parse(stdout);
  const [shown, glimpsed] = await page.evaluate(() => [granulens.state.scenes.whole.numbers, granulens.state.scenes.fine.numbers]);
  for (const key of ["step_s", "window_s", "verdict", "forces_N", "arrangements", "proposal", "target"]) equal(shown[key], command[key], key);
  // The fine numbers come without a ledger, but are the same ones.
  for (const [k, arrangement] of command.arrangements.entries()) {
    for (const name of ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "protection", "mass_kg"]) {
      equal(glimpsed.arrangements[k].scores[name], arrangement.scores[name], `${arrangement.name} ${name}`);
    }
  }
  const one = JSON.parse(desk.granulens("compare", "small.toml", "--json", "--forces", "1").stdout);
  equal(glimpsed.verdict, one.verdict, "the verdict at one force");
  equal(await page.textContent("#score-C"), Number(command.arrangements[0].scores.contrast.toPrecision(3)).toFixed(2).replace(/^(\d\d\.\d)\d$/, "$1"), "C as it is shown");
}

export async function keyboard_alone_is_enough(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  // By the Tab key to the focal region, through all that stands before it.
  for (let k = 0; k < 80; k += 1) {
    await page.keyboard.press("Tab");
    if (await page.evaluate(() => document.activeElement?.dataset?.key === "target.focus" && document.activeElement.classList.contains("region"))) break;
  }
  const label = () => page.evaluate(() => document.activeElement.getAttribute("aria-label"));
  assert((await label())?.startsWith("focus region, rows 16 to 18"), `focused is ${await label()}`);
  await page.keyboard.press("ArrowDown");
  await page.waitForFunction(() => granulens.state.design.foci[0].rows[0] === 17);
  await page.keyboard.press("Shift+ArrowRight");
  await page.waitForFunction(() => granulens.state.design.foci[0].x[1] === 2);
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await page.waitForFunction(() => granulens.state.design.foci[0].rows[0] === 16 && granulens.state.design.foci[0].x[1] === 1.5);
  // A sphere is read by the arrow keys.
  await page.focus("#crystal");
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowDown");
  await desk.rest(page);
  const words = await page.textContent("#sphere");
  assert(words.includes("row 2, column 1") && words.includes("greatest kinetic energy") && words.includes("reached at"), words);
}

export async function a_wrong_value_is_answered_at_its_control(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const page = await desk.page();
  const force = page.locator('[data-key="impact.force"] input');
  await force.fill("26 kg");
  await force.press("Enter");
  await page.waitForSelector('[data-key="impact.force"].wrong');
  assert((await page.textContent('[data-key="impact.force"] .why')).includes("26 kg"), "the reason");
  await force.fill("12 kN");
  await force.press("Enter");
  await page.waitForFunction(() => granulens.state.design.impact.startsWith("12 kN") && !document.querySelector(".wrong"));
  // A target that no lens serves is told, and why.
  await page.selectOption('[data-key="lens.material"] select', "tungsten-carbide");
  await page.waitForSelector("#unreachable");
  assert((await page.textContent("#unreachable")).includes("gathers nothing"), await page.textContent("#unreachable"));
  await page.selectOption('[data-key="lens.material"] select', "brass-260");
  await page.waitForSelector("#unreachable", { state: "detached" });
}

export async function what_is_saved_gives_the_same_numbers(desk) {
  await desk.explore();
  const page = await desk.page();
  await page.locator('[data-key="crystal.rows"] input').fill("40");
  await page.locator('[data-key="crystal.rows"] input').press("Enter");
  await page.waitForFunction(() => granulens.state.design.rows === 40);
  await page.click("#save");
  await page.click("#save-design");
  await page.waitForFunction(() => document.querySelector("dialog").textContent.includes("saved as my-lens.toml"));
  await page.click("#save-layout");
  await page.waitForFunction(() => document.querySelector("dialog").textContent.includes("saved as my-lens.csv"));
  await page.keyboard.press("Escape");
  equal(desk.read("my-lens.toml"), await page.evaluate(() => granulens.state.text));
  const made = desk.granulens("design", "my-lens.toml", "--quiet");
  equal(made.status, 0, made.stderr);
  equal(desk.read("my-lens.csv"), made.stdout, "the layout is that of granulens design");
  await desk.rest(page);
  await page.click("#command");
  assert((await page.textContent("dialog")).includes("granulens compare my-lens.toml"), await page.textContent("dialog"));
  const shown = await page.evaluate(() => granulens.state.scenes.whole.numbers.arrangements[0].scores);
  const command = JSON.parse(desk.granulens("compare", "my-lens.toml", "--json").stdout);
  equal(shown, command.arrangements[0].scores);
}

export async function a_reload_keeps_the_design_and_two_tabs_do_no_harm(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore("small.toml");
  const [one, two] = [await desk.page(), await desk.page()];
  await drag(one, '[data-key="target.focus"]', [0.5, 1]);
  await drag(two, '[data-key="target.protect"]', [0, 1]);
  await one.waitForFunction(() => granulens.state.design.foci[0].rows[0] === 17);
  await two.waitForFunction(() => granulens.state.design.protect.rows[0] === 17);
  await Promise.all([desk.rest(one), desk.rest(two)]);
  equal((await focusOf(two)).rows, [16, 18], "the other tab's focus");
  const text = await one.evaluate(() => granulens.state.text);
  await one.reload();
  await one.waitForFunction(() => globalThis.granulens?.state.design);
  equal(await one.evaluate(() => granulens.state.text), text, "after the reload");
}

export async function wide_narrow_dark_and_light(desk) {
  desk.write("small.toml", SMALL);
  await desk.explore();
  for (const [width, scheme] of [[1280, "light"], [1280, "dark"], [400, "light"], [400, "dark"]]) {
    const page = await desk.page({ width, scheme });
    await desk.rest(page);
    const over = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert(over <= 0, `at ${width} px the page is ${over} px too wide`);
    await picture(page, `design-${width}-${scheme}`, { fullPage: width < 1000 });
    await page.selectOption("#map", "materials");
    await picture(page, `materials-${width}-${scheme}`, { fullPage: width < 1000 });
  }
}

/// A drag over rows and columns, as fast as the pointer moves: the picture follows within 50 ms, coarse numbers within half a second.
export async function the_lens_follows_a_drag(desk) {
  await desk.explore();
  const page = await desk.page();
  await desk.rest(page);
  await page.evaluate(() => {
    granulens.latency.length = 0;
    granulens.coarse = [];
    granulens.state.on("scene", () => granulens.state.scene.detail === "coarse" && granulens.coarse.push(granulens.state.scene.since));
  });
  for (const by of [[6, -4], [-3, 5], [2, -3]]) {
    await drag(page, '[data-key="target.focus"]', by, 40);
    await page.waitForTimeout(100);
  }
  await desk.rest(page);
  const [proposal, coarse, ms] = await page.evaluate(() => [granulens.latency, granulens.coarse, granulens.state.ms]);
  const at = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))];
  const told = (list) => `median ${at(list, 0.5).toFixed(0)} ms, 95 of 100 within ${at(list, 0.95).toFixed(0)} ms, ${list.length} times`;
  console.log(`  proposal and picture after a move: ${told(proposal)} (${ms.toFixed(1)} ms of it the last proposal)`);
  console.log(`  coarse numbers after a change: ${told(coarse)}`);
  assert(proposal.length > 20 && coarse.length > 3, "too few to tell");
  if (process.env.BENCH) assert(at(proposal, 0.95) < 50 && at(coarse, 0.95) < 500, "too slow");
}
