// Drives the page in Chromium: every action, by keyboard too, on a desk and on a phone, light and dark.
import assert from "node:assert";
import { createRequire } from "node:module";

const load = createRequire(process.env.NODE_PATH + "/");
const puppeteer = load("puppeteer-core");
const axe = load.resolve("axe-core/axe.min.js");
const link = process.argv[2];

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  headless: true,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
const faults = [];
const page = await browser.newPage();
page.on("pageerror", (e) => faults.push(`script: ${e.message}`));
page.on("console", (m) => { if (m.type() === "error") faults.push(`console: ${m.text()}`); });
page.on("dialog", (d) => { faults.push("a dialog: a name became code"); d.dismiss(); });

async function check(what) {
  const found = await page.evaluate(async () => {
    const { violations } = await axe.run();
    return violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(" ")).join(", ")}`);
  });
  faults.push(...found.map((f) => `${what}: ${f}`));
}

try {
  await page.setBypassCSP(true); // for axe alone; the policy itself is tested elsewhere
  await page.goto(link, { waitUntil: "domcontentloaded" });
  assert.ok(!page.url().includes("token"), "the token stays in the address");
  await page.waitForFunction(() => document.querySelectorAll("#drawings a").length >= 2);
  const names = await page.$$eval("#drawings a", (as) => as.map((a) => a.firstChild.textContent));
  assert.ok(names.includes("<img src=x onerror=alert(1)>.dxf"), names.join());
  await page.addScriptTag({ path: axe });
  await check("list");

  // By keyboard: to the drawing and into it.
  const gallery = await page.evaluateHandle(() => [...document.querySelectorAll("#drawings a")].find((a) => a.textContent.startsWith("gallery.dxf")));
  await gallery.focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector("#show-1");
  assert.equal(await page.evaluate(() => document.activeElement.id), "main");

  // Slider and heat maps.
  await page.focus(".pair + input");
  const clip = () => page.$eval(".pair img + img", (i) => i.style.clipPath);
  const before = await clip();
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await clip(), before);
  await page.select("#measure", "2");
  await page.waitForFunction(() => [...document.querySelectorAll(".pair img")].every((i) => i.src.endsWith("-depth.png") && i.complete && i.naturalWidth > 0));

  // Choose, pin, filter, scatter.
  await page.click("#show-1");
  assert.match(await page.$eval("#words", (w) => w.textContent), /^Option 2/);
  await page.click("#pin-1");
  assert.equal(await page.$eval("tbody tr.pinned th", (t) => t.textContent), "2");
  await page.select("#scatter-x", "1");
  await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  const rows = () => page.$$eval("#options .scroll:not(details *) tbody tr", (r) => r.length);
  const all = await rows();
  const top = await page.$(".axes input");
  await page.$eval(".axes fieldset input", (i) => { i.value = "1e9"; i.dispatchEvent(new Event("change")); });
  assert.equal(await rows(), 0);
  await page.$eval(".axes fieldset input", (i) => { i.value = ""; i.dispatchEvent(new Event("change")); });
  assert.equal(await rows(), all);
  assert.ok(top);

  await check("light");
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await check("dark");
  await page.setViewport({ width: 360, height: 740 });
  await check("phone");
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "scrolls sideways on a phone");
  await page.setViewport({ width: 1280, height: 900 });

  // Accept, another round with other thresholds, cancel.
  await page.click("#accept-0");
  await page.waitForFunction(() => document.getElementById("said").textContent.includes("gallery-r02.dxf"));
  await page.waitForFunction(() => [...document.querySelectorAll("#drawings a")].some((a) => a.textContent.startsWith("gallery-r02.dxf")));
  await page.evaluate(() => { document.querySelectorAll("details").forEach((d) => { d.open = true; }); });
  await page.$eval("details.card fieldset input[max='1']", (i) => { i.value = "0.5"; });
  await page.click("#again-with");
  await page.waitForFunction(() => document.getElementById("said").textContent.includes("0.5"));
  await page.waitForFunction(() => !document.getElementById("cancel").disabled, { timeout: 60000 });
  await page.click("#cancel");
  await page.waitForFunction(() => document.getElementById("again") && !document.getElementById("again").disabled, { timeout: 120000 });
  assert.ok(await page.$$eval("#log li", (l) => l.length) > 2);
} catch (e) {
  faults.push(e.stack ?? String(e), await page.$eval("body", (b) => b.innerText.slice(0, 1500)).catch(() => ""));
} finally {
  await browser.close();
}
if (faults.length) {
  console.error([...new Set(faults)].join("\n"));
  process.exit(1);
}
