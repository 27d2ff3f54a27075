// More tabs than a browser opens connections: each gets the news, also when the one that listens goes, and each finds
// the daemon again by itself.
import assert from "node:assert";
import { spawn } from "node:child_process";
import { copyFileSync } from "node:fs";
import { launch, PATIENCE } from "./browser.mjs";

const [link, told] = process.argv.slice(2);
const daemon = JSON.parse(told);
const browser = await launch();
const faults = [];
let second = null;
const TABS = 10;
// Tabs in the background draw nothing: they are looked at by the clock.
const live = (page) =>
  page.waitForFunction(() => document.getElementById("link").textContent === "live", { timeout: PATIENCE, polling: 200 });
const lists = (page, count) =>
  page.waitForFunction((n) => document.querySelectorAll("#drawings a").length === n, { timeout: PATIENCE, polling: 200 }, count);
try {
  const first = await browser.newPage();
  await first.goto(link);
  await live(first);
  // Nothing was chosen: the only drawing is shown, with its papers.
  await first.waitForSelector("#papers a[href*=mac]");
  const papers = await first.$$eval("#papers a", (as) => as.map((a) => [a.textContent, a.href]));
  assert.deepEqual(papers.map((p) => p[0]), ["Report of round 1", "What was understood"]);
  for (const [, address] of papers) {
    const paper = await browser.newPage();
    const answer = await paper.goto(address);
    assert.equal(answer.status(), 200, address);
    const origin = await paper.evaluate(() => self.origin);
    assert.ok(!address.includes("report.html") || origin === "null", "the report has the page's origin");
    await paper.close();
  }
  const tabs = [first];
  for (let i = 1; i < TABS; i += 1) {
    const page = await browser.newPage();
    page.on("pageerror", (e) => faults.push(`script: ${e.message}`));
    // Without the key: the browser knows it by now.
    await page.goto(link.split("#")[0]);
    await live(page);
    await page.waitForFunction(() => document.getElementById("standing"), { polling: 200 });
    tabs.push(page);
  }
  copyFileSync(daemon.drawing, daemon.drawing.replace("gallery", "second"));
  for (const page of tabs) await lists(page, 2);
  await tabs.shift().close();
  copyFileSync(daemon.drawing, daemon.drawing.replace("gallery", "third"));
  for (const page of tabs) await lists(page, 3);
  process.kill(daemon.pid, "SIGKILL");
  await tabs[0].waitForFunction(() => document.getElementById("link").textContent.includes("out of reach"), { polling: 200 });
  second = spawn(daemon.program, daemon.args, { stdio: "ignore" });
  for (const page of tabs) await live(page);
  await tabs.at(-1).reload();
  await live(tabs.at(-1));
} catch (e) {
  faults.push(e.stack ?? String(e));
} finally {
  second?.kill("SIGKILL");
  await browser.close();
}
if (faults.length) {
  console.error([...new Set(faults)].join("\n"));
  process.exit(1);
}
