// Opens a report of `rtscript test --html` in headless Chromium and works it as a reader does: mouse, keys, filters,
// light and dark, reduced motion, a narrow window. Fails where something does not answer, where the page asks for
// anything beyond itself, or where it says an error; leaves screenshots to be looked at.
//
//   npm install && node look.mjs REPORT.html [FOLDER FOR SCREENSHOTS]
//
// The report must have a changed case with a reference picture of the same size. CHROMIUM names the browser.

import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [report, folder = "screenshots"] = process.argv.slice(2);
assert.ok(report, "usage: node look.mjs REPORT.html [FOLDER FOR SCREENSHOTS]");
mkdirSync(folder, { recursive: true });
const url = pathToFileURL(resolve(report)).href;
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });

/** A page with the report, and what it asked for and complained of. */
async function open(options) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  const seen = { requests: [], errors: [] };
  page.on("request", request => {
    if (!request.url().startsWith("data:")) seen.requests.push(request.url());
  });
  page.on("console", message => {
    if (["error", "warning"].includes(message.type())) seen.errors.push(message.text());
  });
  page.on("pageerror", error => seen.errors.push(String(error)));
  await page.goto(url);
  return { page, seen, close: () => context.close() };
}

const shot = (target, name) => target.screenshot({ path: `${folder}/${name}.png` });
const checked = [];
async function check(what, body) {
  await body();
  checked.push(what);
  console.log(`ok  ${what}`);
}

try {
  const { page, seen, close } = await open({ colorScheme: "light" });
  const card = page.locator(".case:has(.heat)").first();
  const viewer = card.locator(".viewer");
  const handle = card.getByRole("slider");
  const cut = () => card.locator("figure.actual").evaluate(e => getComputedStyle(e).clipPath);
  const now = async () => Number(await handle.getAttribute("aria-valuenow"));
  const mode = () => viewer.getAttribute("data-mode");
  const shown = name => card.locator(`figure.${name}`).isVisible();

  await shot(page, "01-top");

  await check("the slider stands in the middle", async () => {
    await card.scrollIntoViewIfNeeded();
    assert.equal(await now(), 50);
    assert.equal(await cut(), "inset(0px 0px 0px 50%)");
    assert.ok((await shown("expected")) && (await shown("actual")));
    await shot(card, "02-slider-middle");
  });

  await check("the mouse moves it", async () => {
    const box = await card.locator(".stage").boundingBox();
    const at = part => [box.x + box.width * part, box.y + box.height * 0.4];
    await page.mouse.move(...at(0.5));
    await page.mouse.down();
    await page.mouse.move(...at(0.35), { steps: 5 });
    await page.mouse.move(...at(0.2), { steps: 5 });
    await page.mouse.up();
    assert.equal(await now(), 20);
    assert.match(await cut(), /^inset\(0px 0px 0px (20|19\.9|20\.1)%\)$/);
    await page.mouse.move(...at(0.9));
    assert.equal(await now(), 20, "it moves without the button held");
    await shot(card, "03-slider-by-mouse");
  });

  await check("left of the handle is the expected picture, right of it the one of now", async () => {
    const top = await card.locator(".stage").evaluate(stage => {
      stage.scrollIntoView({ block: "center" });
      const box = stage.getBoundingClientRect();
      const figure = part => {
        const hits = document.elementsFromPoint(box.left + box.width * part, box.top + box.height / 2);
        return hits.find(e => e.tagName === "IMG")?.closest("figure").className;
      };
      return [figure(0.1), figure(0.6)];
    });
    assert.deepEqual(top, ["expected", "actual"]);
  });

  await check("so do the keys", async () => {
    await handle.focus();
    const after = async key => {
      await page.keyboard.press(key);
      return now();
    };
    assert.equal(await after("ArrowRight"), 21);
    assert.equal(await after("ArrowLeft"), 20);
    assert.equal(await after("Shift+ArrowRight"), 30);
    assert.equal(await after("PageUp"), 40);
    assert.equal(await after("Home"), 0);
    assert.equal(await after("ArrowLeft"), 0);
    assert.equal(await cut(), "inset(0px 0px 0px 0%)");
    assert.equal(await after("End"), 100);
    assert.equal(await handle.getAttribute("aria-valuetext"), "100 % expected");
    await page.keyboard.press("Home");
    for (let i = 0; i < 7; i++) await page.keyboard.press("PageUp");
    assert.equal(await now(), 70);
    await shot(card, "04-slider-by-keys");
  });

  await check("heat, difference and side by side", async () => {
    await page.keyboard.press("h");
    assert.equal(await mode(), "heat");
    assert.ok((await shown("heat")) && !(await shown("actual")) && !(await handle.isVisible()));
    await shot(card, "05-heat");
    await page.keyboard.press("d");
    assert.ok((await mode()) === "difference" && (await shown("difference")));
    await shot(card, "06-difference");
    await page.keyboard.press("x");
    const [left, right] = await Promise.all(
      ["expected", "actual"].map(name => card.locator(`figure.${name} img`).boundingBox()),
    );
    const frame = await card.locator(".frame").boundingBox();
    assert.ok(left.x + left.width <= right.x && left.y === right.y);
    assert.ok(right.x + right.width <= frame.x + frame.width, "both are in sight");
    await shot(card, "07-side-by-side");
  });

  await check("blink shows each picture twice a second", async () => {
    await page.keyboard.press("b");
    assert.equal(await mode(), "blink");
    const turns = await viewer.evaluate(root => new Promise(done => {
      let turns = 0;
      const observer = new MutationObserver(() => { turns += 1; });
      observer.observe(root, { attributes: true, attributeFilter: ["class"] });
      setTimeout(() => done(turns), 2100);
    }));
    assert.ok(turns >= 6 && turns <= 9, `${turns} turns in 2.1 s`);
    await shot(card, "08-blink");
    await page.keyboard.press("b");
    assert.equal(await mode(), "slider");
  });

  await check("zoom is sharp and finds the change", async () => {
    const width = () => card.locator("figure.actual img").evaluate(e => e.getBoundingClientRect().width);
    const before = await width();
    await page.keyboard.press("z");
    assert.ok((await width()) >= before);
    const rendering = await card.locator("figure.actual img").evaluate(e => getComputedStyle(e).imageRendering);
    assert.equal(rendering, "pixelated");
    const [frame, region] = await Promise.all([
      card.locator(".frame").boundingBox(),
      card.locator("figure.expected .region rect").boundingBox(),
    ]);
    const inside = (low, high, start, size) => start >= low - 1 && start + size <= low + high + 1;
    assert.ok(inside(frame.x, frame.width, region.x, region.width), "the change is in sight");
    await shot(card, "09-zoom");
    await page.keyboard.press("o");
    assert.ok(!(await card.locator("figure.expected .region").isVisible()));
    await page.keyboard.press("o");
    await page.keyboard.press("0");
    assert.equal(await width(), before);
  });

  await check("j and k go through the cases", async () => {
    const current = () => page.locator(".case.current").getAttribute("id");
    await page.evaluate(() => document.activeElement.blur());
    const cases = await page.locator(".case").count();
    for (let i = 0; i < cases; i++) await page.keyboard.press("k");
    assert.equal(await current(), "case-0");
    if (cases > 1) {
      await page.keyboard.press("j");
      assert.equal(await current(), "case-1");
      await page.keyboard.press("k");
      assert.equal(await current(), "case-0");
    }
    // The page scrolls there smoothly, on a busy machine slowly.
    await page.waitForFunction(() => {
      const [top, first] = [".top", "#case-0"].map(name => document.querySelector(name).getBoundingClientRect());
      return first.y >= top.y + top.height;
    });
    await page.locator(".keys summary").click();
    await shot(page, "10-first-case");
    await page.locator(".keys summary").click();
  });

  await check("filters and search", async () => {
    const visible = () => page.locator(".case:visible").count();
    const everything = await visible();
    await page.locator('.filter[data-show="changed"]').click();
    assert.equal(await visible(), await page.locator(".case.changed").count());
    await page.locator('.filter[data-show="all"]').click();
    assert.equal(await visible(), everything);
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("/");
    await page.keyboard.type("no such name hjkb");
    assert.equal(await visible(), 0);
    assert.ok(await page.locator(".nothing").isVisible());
    await page.keyboard.press("ControlOrMeta+a");
    await page.keyboard.press("Backspace");
    await page.keyboard.press("Escape");
    assert.equal(await visible(), everything);
  });

  await check("it asked for nothing and complained of nothing", () => {
    assert.deepEqual(seen.requests, [url]);
    assert.deepEqual(seen.errors, []);
  });
  await page.screenshot({ path: `${folder}/11-whole-page.png`, fullPage: true });

  await check("and it could not have", async () => {
    const blocked = await page.evaluate(async () => {
      const violations = [];
      addEventListener("securitypolicyviolation", event => violations.push(event.effectiveDirective));
      const image = document.createElement("img");
      image.src = "https://example.invalid/a.png";
      const script = document.createElement("script");
      script.textContent = "window.ran = true";
      document.body.append(image, script);
      document.body.insertAdjacentHTML("beforeend", "<b id=x onclick='window.ran = true'>x</b>");
      document.getElementById("x").click();
      await fetch("https://example.invalid/b").catch(() => {});
      await new Promise(done => setTimeout(done, 300));
      return { ran: window.ran === true, violations };
    });
    assert.equal(blocked.ran, false);
    for (const directive of ["img-src", "script-src-elem", "script-src-attr", "connect-src"]) {
      assert.ok(blocked.violations.includes(directive), `${directive}: ${blocked.violations}`);
    }
  });
  await close();

  await check("with reduced motion nothing blinks by itself", async () => {
    const { page, seen, close } = await open({ colorScheme: "dark", reducedMotion: "reduce" });
    await shot(page, "12-dark");
    const card = page.locator(".case:has(.heat)").first();
    await card.locator("header").click();
    await page.keyboard.press("b");
    const isNow = () => card.locator(".viewer").evaluate(e => e.classList.contains("now"));
    await page.waitForTimeout(800);
    assert.equal(await isNow(), false);
    await page.keyboard.press("b");
    assert.equal(await isNow(), true);
    await shot(card, "13-dark-blink");
    assert.deepEqual(seen.errors, []);
    await close();
  });

  await check("a narrow window does not scroll sideways", async () => {
    const { page, seen, close } = await open({ viewport: { width: 420, height: 800 } });
    const [wide, room] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(wide <= room, `${wide} of ${room}`);
    await page.locator(".case:has(.heat)").first().scrollIntoViewIfNeeded();
    await shot(page, "14-narrow");
    assert.deepEqual(seen.errors, []);
    await close();
  });
  console.log(`${checked.length} checks passed; screenshots are in ${resolve(folder)}`);
} finally {
  await browser.close();
}
