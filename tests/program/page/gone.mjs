// The only drawing goes while it is looked at: its panel, and what could be ordered there, go too.
import { rmSync } from "node:fs";
import { createRequire } from "node:module";

const puppeteer = createRequire(process.env.NODE_PATH + "/")("puppeteer-core");
const [link, drawing] = process.argv.slice(2);
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  headless: true,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
const faults = [];
try {
  const page = await browser.newPage();
  page.on("pageerror", (e) => faults.push(`script: ${e.message}`));
  page.setDefaultTimeout(900000);
  await page.goto(link);
  await page.waitForSelector("#drawings a");
  await page.click("#drawings a");
  await page.waitForSelector("#accept-0");
  rmSync(drawing);
  await page.waitForFunction(() => document.querySelector("#drawings").textContent.startsWith("No drawing yet"));
  await page.waitForFunction(() => document.getElementById("title")?.textContent === "No such drawing", { timeout: 900000 });
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
