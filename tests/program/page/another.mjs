// Another drawing goes while one is looked at: the list changes, and nothing else.
import assert from "node:assert";
import { rmSync } from "node:fs";
import { launch, PATIENCE } from "./browser.mjs";

const [link, drawing] = process.argv.slice(2);
const browser = await launch();
const faults = [];
try {
  const page = await browser.newPage();
  page.on("pageerror", (e) => faults.push(`script: ${e.message}`));
  page.setDefaultTimeout(PATIENCE);
  await page.goto(link);
  const rowOf = (name) => page.waitForFunction((n) => [...document.querySelectorAll("#drawings a")].find((a) => a.textContent.startsWith(n)), {}, name);
  const names = () => page.$$eval("#drawings a", (as) => as.map((a) => a.firstChild.textContent));
  await rowOf("other.dxf");
  await (await rowOf("gallery.dxf")).click();
  await page.waitForSelector("#accept-0");
  await page.evaluate(() => {
    document.querySelectorAll("details").forEach((d) => { d.open = true; });
    const filter = document.querySelector(".axes fieldset input");
    filter.value = "1e9";
    filter.dispatchEvent(new Event("change"));
  });
  await page.select("#scatter-x", "2");
  await page.focus("#again-with");
  const look = () => page.evaluate(() => [document.querySelector("#options [role=status]").textContent, document.querySelector("#scatter-x").value,
    document.activeElement.id, [...document.querySelectorAll("#main details")].every((d) => d.open)]);
  const before = await look();
  assert.deepEqual(before, [before[0], "2", "again-with", true]);
  assert.match(before[0], /^0 of /);
  rmSync(drawing);
  await page.waitForFunction(() => document.querySelectorAll("#drawings a").length === 1);
  // Time for whatever else might still come.
  await new Promise((done) => setTimeout(done, 1500));
  assert.deepEqual(await names(), ["gallery.dxf"]);
  assert.deepEqual(await look(), before);
} catch (e) {
  faults.push(e.stack ?? String(e));
} finally {
  await browser.close();
}
if (faults.length) {
  console.error(faults.join("\n"));
  process.exit(1);
}
