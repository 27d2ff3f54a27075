// The only drawing goes while it is looked at: its panel, and what could be ordered there, go too.
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
  await page.waitForSelector("#drawings a");
  await page.click("#drawings a");
  await page.waitForSelector("#accept-0");
  rmSync(drawing);
  await page.waitForFunction(() => document.querySelector("#drawings").textContent.startsWith("No drawing yet"));
  await page.waitForFunction(() => document.getElementById("title")?.textContent === "No such drawing");
  if (await page.$("#main button")) faults.push("a button of the drawing is still there");
} catch (e) {
  faults.push(e.stack ?? String(e));
} finally {
  await browser.close();
}
if (faults.length) {
  console.error(faults.join("\n"));
  process.exit(1);
}
