// Drives the page in Chromium: every action, by keyboard too, on a desk and on a phone, light and dark.
import assert from "node:assert";
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { launch, PATIENCE } from "./browser.mjs";

const axe = createRequire(process.env.NODE_PATH + "/").resolve("axe-core/axe.min.js");
const link = process.argv[2];
/** The daemon: its process, and how it is started again on the same port. */
const daemon = JSON.parse(process.argv[3]);
let second = null;
/** A folder for pictures of every view, to be looked at. */
const shots = process.env.ENFILADE_LOOK;

const browser = await launch();
const faults = [];
const page = await browser.newPage();
// Jobs stand back for whatever else the machine does: how long one takes says nothing here.
page.setDefaultTimeout(PATIENCE);
page.on("pageerror", (e) => faults.push(`script: ${e.message}`));
let isGone = false;
page.on("console", (m) => {
  if (m.type() === "error" && !(isGone && m.text().startsWith("Failed to load"))) faults.push(`console: ${m.text()}`);
});
const sent = [];
page.on("request", (r) => { if (r.method() === "POST") sent.push(JSON.parse(r.postData())); });
page.on("dialog", (d) => { faults.push("a dialog: a name became code"); d.dismiss(); });

const text = (selector) => page.$eval(selector, (e) => e.textContent);
const said = (part) => page.waitForFunction((p) => document.getElementById("said").textContent.includes(p), {}, part);
/** No job runs or waits: another may be asked for. */
const idle = () => page.waitForFunction(() => document.getElementById("again")?.disabled === false);
/** Clicks what is there, or comes, where a pointer would: at once, since the page may draw a part anew at any moment. */
const press = async (selector) => {
  await page.waitForFunction((s) => {
    const button = document.querySelector(s);
    if (!button || button.disabled) return false;
    button.scrollIntoView({ block: "center", behavior: "instant" });
    const at = button.getBoundingClientRect();
    if (!button.contains(document.elementFromPoint(at.x + at.width / 2, at.y + at.height / 2))) return false;
    button.focus();
    button.click();
    return true;
  }, {}, selector);
};
const unfold = () => page.evaluate(() => { document.querySelectorAll("details").forEach((d) => { d.open = true; }); });
let pictures = 0;

async function check(what) {
  if (shots) await page.screenshot({ path: `${shots}/${String(pictures += 1).padStart(2, "0")}-${what.replaceAll(" ", "-")}.png`, fullPage: true });

  const found = await page.evaluate(async () => {
    const { violations } = await axe.run();
    return violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(" ")).join(", ")}`);
  });
  faults.push(...found.map((f) => `${what}: ${f}`));
}

try {
  await page.setBypassCSP(true); // for axe alone; the policy itself is tested elsewhere
  await page.goto(link, { waitUntil: "domcontentloaded" });
  assert.ok(!page.url().includes("key="), "the key stays in the address");
  await page.waitForFunction(() => document.querySelectorAll("#drawings a").length >= 2);
  const names = await page.$$eval("#drawings a", (as) => as.map((a) => a.firstChild.textContent));
  assert.ok(names.includes("<img src=x onerror=alert(1)>.dxf"), names.join());
  const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
  console.log(`first paint after ${Math.round(paint)} ms`);
  await page.addScriptTag({ path: axe });
  await check("list");

  // Names that two folders have are told apart; control characters in them are shown.
  const places = await page.$$eval("#drawings a", (as) =>
    as.map((a) => [a.firstChild.textContent, a.querySelector(".place")?.textContent]).filter(([name, place]) => place || name === "gallery.dxf"));
  assert.deepEqual(places, [["broken.dxf", "plans"], ["broken.dxf", "plans/<i>wing"], ["gallery.dxf", null]].map(([n, p]) => [n, p ?? undefined]));
  assert.ok(names.includes("\\u{202e}fxd.thgir.dxf"), names.join());

  // Files left alone, with the reason.
  await page.focus("#left-title");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.getElementById("left").open);
  assert.match(await text("#left-files"), /#<b>\.dxf.*LibreCAD/);
  assert.ok(await page.$$eval("#left-rules li", (l) => l.length) > 20);
  await check("left alone");

  // By keyboard: to the drawing and into it.
  const gallery = await page.evaluateHandle(() => [...document.querySelectorAll("#drawings a")].find((a) => a.textContent.startsWith("gallery.dxf")));
  await gallery.focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector("#show-1");
  assert.equal(await page.evaluate(() => document.activeElement.id), "title");
  assert.equal(await text("#title"), "gallery.dxf");
  const axes = await page.$$eval("#scatter-x option", (os) => os.map((o) => o.textContent));
  assert.ok(axes.includes("clearance, m²") && axes.some((a) => / x, m$/.test(a)) && axes.some((a) => / rotate, °$/.test(a)) && !axes.some((a) => a.includes("_m")), axes.join());

  // Slider and heat maps.
  await page.focus(".pair + input");
  const clip = () => page.$eval(".pair img + img", (i) => i.style.clipPath);
  const before = await clip();
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await clip(), before);
  await page.select("#measure", "2");
  await page.waitForFunction(() => [...document.querySelectorAll(".pair img")].every((i) => i.src.split("?")[0].endsWith("-depth.png") && i.complete && i.naturalWidth > 0));

  // Choose, pin, filter, scatter.
  await press("#show-1");
  assert.match(await page.$eval("#words", (w) => w.textContent), /^Option 2/);
  const isPinned = () => page.$eval("#chosen-pin", (b) => [b.textContent, b.getAttribute("aria-pressed")].join());
  await press("#chosen-pin");
  assert.equal(await isPinned(), "Pin option 2,true");
  await press("#chosen-pin");
  assert.equal(await isPinned(), "Pin option 2,false");
  await press("#pin-1");
  assert.equal(await isPinned(), "Pin option 2,true");
  assert.equal(await page.$eval("tbody tr.pinned th", (t) => t.textContent), "2");
  await page.select("#scatter-x", "1");
  await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  const rows = () => page.$$eval("#options .scroll:not(details *) tbody tr", (r) => r.length);
  const all = await rows();
  await page.$eval(".axes fieldset input", (i) => { i.value = "1e9"; i.dispatchEvent(new Event("change")); });
  assert.equal(await rows(), 0);
  await page.$eval(".axes fieldset input", (i) => { i.value = ""; i.dispatchEvent(new Event("change")); });
  assert.equal(await rows(), all);

  // A range drawn along the first axis with the pointer, and taken off again by a click.
  const drag = async (steps) => {
    const view = await page.$("#options canvas");
    await view.scrollIntoView();
    const box = await view.boundingBox();
    await page.mouse.move(box.x + 46, box.y + 90);
    await page.mouse.down();
    for (let i = 1; i <= steps; i += 1) await page.mouse.move(box.x + 46, box.y + 90 + (box.height - 130) * i / steps);
    await page.mouse.up();
    return box;
  };
  const box = await drag(8);
  const narrowed = await page.$eval(".axes fieldset label + label input", (i) => i.valueAsNumber);
  assert.ok(Number.isFinite(narrowed) && narrowed < await page.$eval(".axes fieldset label input", (i) => i.valueAsNumber) + 1e9);
  await page.waitForFunction((n) => document.querySelectorAll("#options .scroll:not(details *) tbody tr").length < n, {}, all);
  await page.mouse.click(box.x + 46, box.y + 100);
  await page.waitForFunction((n) => document.querySelectorAll("#options .scroll:not(details *) tbody tr").length === n, {}, all);
  // The scatter: a click on the dot that stands at the upper end of its first axis chooses that option.
  const best = await page.$$eval("#options .scroll:not(details *) tbody tr", (rs) =>
    rs.map((r) => [r.querySelector("th").textContent, Number(r.children[2].textContent)]).sort((a, b) => b[1] - a[1])[0][0]);
  await page.select("#scatter-x", "0");
  await page.select("#scatter-y", "0");
  const dots = await page.$("#options canvas ~ canvas");
  await dots.scrollIntoView();
  const field = await dots.boundingBox();
  await page.mouse.click(field.x + field.width - 46, field.y + 34 + 6);
  assert.match(await text("#words"), new RegExp(`^Option ${best}[ :]`));
  assert.match(await text("#stays"), /: 2\.$/);
  assert.ok((await page.$$eval("#options details td", (t) => t.map((e) => e.textContent))).some((t) => t.includes("gallery.dxf")), "problems without a place");

  await check("light");
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await check("dark");
  await page.setViewport({ width: 390, height: 844 });
  await check("phone dark");
  // A long list lies above: the chosen drawing's title is in view and has the focus, one that failed too.
  for (const name of ["sheet-30.dxf", "gallery.dxf", "gallery.dxf"]) {
    const rowOf = await page.evaluateHandle((n) => [...document.querySelectorAll("#drawings a")].find((a) => a.textContent.startsWith(n)), name);
    await rowOf.click();
    await page.waitForFunction((n) => document.activeElement.id === "title" && document.activeElement.textContent === n, {}, name);
    const at = await page.$eval("#title", (t) => t.getBoundingClientRect().top);
    assert.ok(at >= 0 && at < 422, `the title of ${name} is ${at} pixels below the upper edge`);
    if (shots) await page.screenshot({ path: `${shots}/chosen-${name}.png` });
  }
  await page.waitForSelector("#pin-1");
  // What is pinned outlives that something else was shown.
  assert.equal(await page.$eval("#pin-1", (b) => b.getAttribute("aria-pressed")), "true");
  await press("#pin-1");
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "light" }]);
  await page.setViewport({ width: 360, height: 740 });
  await check("phone");
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "scrolls sideways on a phone");
  assert.ok(await page.$eval("#accept-0", (b) => [b, b.nextElementSibling].every((e) => e.getBoundingClientRect().right <= innerWidth)),
    "an option cannot be accepted on a phone without scrolling sideways");
  await page.setViewport({ width: 1280, height: 900 });

  // Ten thousand options: as smooth as five.
  await page.select("#round", "round-00");
  await page.waitForFunction(() => document.querySelector("#options [role=status]")?.textContent.startsWith("10000 of 10000"));
  await page.waitForFunction(() => document.querySelectorAll("#options .scroll:not(details *) tbody tr").length === 200);
  const inspector = await page.createCDPSession();
  await inspector.send("Performance.enable", { timeDomain: "threadTicks" });
  const work = async () => (await inspector.send("Performance.getMetrics")).metrics.find((m) => m.name === "TaskDuration").value;
  await page.evaluate(() => {
    window.gaps = [];
    let last = performance.now();
    const tick = (now) => { window.gaps.push(now - last); last = now; requestAnimationFrame(tick); };
    requestAnimationFrame(tick);
  });
  const before10k = await work();
  await drag(60);
  await page.waitForFunction(() => !document.querySelector("#options [role=status]").textContent.startsWith("10000 of"));
  const worked = await work() - before10k;
  const gaps = (await page.evaluate(() => window.gaps.slice(1))).sort((a, b) => a - b);
  console.log(`10,000 options, a range drawn: ${gaps.length} frames, half within ${gaps[gaps.length >> 1].toFixed(0)} ms, ` +
    `nineteen of twenty within ${gaps[Math.floor(gaps.length * 0.95)].toFixed(0)} ms, the longest ${gaps.at(-1).toFixed(0)} ms; ` +
    `the page's own thread worked ${(1000 * worked / gaps.length).toFixed(1)} ms a frame`);
  await check("ten thousand");
  await page.select("#round", "round-01");
  await page.waitForFunction((w) => document.querySelector("#options [role=status]")?.textContent.startsWith(w), {}, `${all} of ${all}`);

  // What a search that goes on has found so far is shown and taken like a round.
  await page.select("#round", "so-far");
  await page.waitForFunction(() => document.querySelector("#round").selectedOptions[0].textContent === "Best so far");
  await page.waitForFunction((w) => document.querySelector("#options [role=status]")?.textContent.startsWith(w), {}, `${all} of ${all}`);
  await press("#accept-1");
  await said("gallery-r02.dxf");
  assert.ok(sent.at(-1).so_far > 0 && sent.at(-1).candidate === 2 && !("round" in sent.at(-1)), JSON.stringify(sent.at(-1)));
  await page.select("#round", "round-01");
  await page.waitForFunction((w) => document.querySelector("#options [role=status]")?.textContent.startsWith(w), {}, `${all} of ${all}`);

  // Accept, more like one, another round with other thresholds and a pinned option, cancel.
  await press("#accept-0");
  await said("gallery-r03.dxf");
  await page.waitForFunction(() => [...document.querySelectorAll("#drawings a")].some((a) => a.textContent.startsWith("gallery-r03.dxf")));
  await idle();
  await press("#show-2");
  await press("#pin-0");
  await press("#chosen-like");
  await said("more like option 3; these stay: 1");
  assert.deepEqual(sent.at(-1), { round: 1, pin: [1], like: 3 });
  await page.waitForFunction(() => document.querySelector("#round option")?.value === "round-02");
  await idle();
  await press("#pin-0");
  const threshold = (value) => page.$eval("details.card fieldset input[max='1']", (i, v) => { i.value = v; i.dispatchEvent(new Event("input")); }, value);
  // A threshold that is no share is refused, and none at all is not taken for another.
  const orders = sent.length;
  for (const [wrong, found] of [["", "found nothing"], ["2", "found 2"], ["-1", "found -1"]]) {
    // What a round that came meanwhile has drawn is folded.
    await unfold();
    await threshold(wrong);
    await press("#again-with");
    await said(`${found}, expected a share from 0 to 1; nothing was done`);
  }
  assert.equal(sent.length, orders);
  await unfold();
  await threshold("0.5");
  await press("#again-with");
  await said("0.5");
  await said("these stay: 1");
  await page.waitForFunction(() => document.querySelector("#round option")?.value === "round-03");
  await idle();
  // The round says which of its options it was told to keep.
  await press("#show-0");
  assert.match(await text("#words"), /^Option 1 \(pinned[;)]/);
  assert.match(await page.$eval("#options .scroll:not(details *) tbody th", (t) => t.textContent), /pinned before$/);
  await press("#show-1");
  assert.doesNotMatch(await text("#words"), /^Option 2 \(pinned/);
  // The plain button keeps what is pinned too, and what is shown stays shown while the round is made.
  await press("#show-1");
  await press("#pin-0");
  await press("#again");
  await said("as the settings say; these stay: 1");
  assert.deepEqual(sent.at(-1), { round: 3, pin: [1] });
  await page.waitForFunction(() => document.getElementById("cancel")?.disabled === false);
  await page.waitForFunction(() => document.getElementById("words")?.textContent.startsWith("Option 2"));
  // Whoever stands on a button stays there while news comes.
  await page.focus("#cancel");
  const progress = await page.$("#standing progress");
  if (progress) await page.waitForFunction((p) => !p.isConnected, {}, progress);
  await page.waitForFunction(() => document.activeElement !== document.body);
  await check("working");
  await idle();
  // A round may be over before it is called off: then the next one is.
  const isCancelled = () => page.$eval("#standing p", (p) => p.textContent.includes("cancelled"));
  for (let tries = 0; tries < 10 && !(await isCancelled()); tries += 1) {
    await press("#again");
    await page.waitForFunction(() => document.getElementById("cancel")?.disabled === false);
    await press("#cancel");
    await idle();
  }
  await page.waitForFunction(() => document.querySelector("#standing p").textContent.includes("cancelled"));
  // Whoever pressed the button by keyboard is not thrown back to the beginning of the page.
  await page.waitForFunction(() => document.activeElement !== document.body);
  // A link to what is no longer watched says so.
  const address = await page.evaluate(() => location.hash);
  await page.evaluate(() => { location.hash = "#gone"; });
  await page.waitForFunction(() => document.getElementById("title")?.textContent === "No such drawing");
  await page.evaluate((a) => { location.hash = a; }, address);
  await page.waitForSelector("#standing");
  assert.ok(await page.$$eval("#log li", (l) => l.length) > 2);
  // A drawing that failed says where.
  await page.evaluate(() => [...document.querySelectorAll("#drawings a")].find((a) => a.textContent.startsWith("broken.dxf")).click());
  await page.waitForFunction(() => document.querySelector("#standing .problem")?.textContent.includes("broken.dxf:"));
  await check("problem");

  // The daemon is gone: nothing is done, and that is said. Another one does not know this page.
  await (await page.evaluateHandle(() => [...document.querySelectorAll("#drawings a")].find((a) => a.textContent.startsWith("gallery.dxf")))).click();
  await page.waitForSelector("#accept-0");
  isGone = true;
  process.kill(daemon.pid, "SIGKILL");
  const linked = (part) => page.waitForFunction((p) => document.getElementById("link").textContent.includes(p), {}, part);
  await linked("out of reach");
  for (const deed of ["#again", "#chosen-accept", "#chosen-like"]) {
    await page.$eval("#said", (s) => { s.textContent = "before"; });
    await press(deed);
    await said("nothing was done: the daemon is out of reach");
  }
  if (shots) await page.screenshot({ path: `${shots}/gone.png` });
  second = spawn(daemon.program, daemon.args, { stdio: "ignore" });
  // The page finds it again by itself, and so does whoever loads it anew.
  await linked("live");
  await press("#chosen-pin");
  if (shots) await page.screenshot({ path: `${shots}/again.png` });
  await page.reload();
  await linked("live");
  await page.waitForSelector("#accept-0");
  // A browser that was never here reads what helps, and nothing of the daemon.
  const stranger = await (await browser.createBrowserContext()).newPage();
  await stranger.goto(link.split("#")[0]);
  await stranger.waitForFunction(() => document.getElementById("link").textContent.includes("enfilade open"));
  assert.equal(await stranger.$$eval("#drawings a", (as) => as.length), 0);
} catch (e) {
  // What was shown comes first: of a long report the end is kept.
  faults.unshift(await page.$eval("body", (b) => b.innerText.slice(0, 1500)).catch(() => ""));
  faults.push(e.stack ?? String(e));
} finally {
  second?.kill("SIGKILL");
  await browser.close();
}
if (faults.length) {
  console.error([...new Set(faults)].join("\n"));
  process.exit(1);
}
