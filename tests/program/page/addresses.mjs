// Another user of the machine has the port while the daemon is down, and leaves a worker and a page that lasts at the
// addresses that the browser knew. The next link leads past them. A link with another key takes the good one from nobody.
import assert from "node:assert";
import { execFileSync, spawn } from "node:child_process";
import { createServer } from "node:http";
import { launch, PATIENCE } from "./browser.mjs";

const [link, told] = process.argv.slice(2);
const daemon = JSON.parse(told);
const browser = await launch();
const port = new URL(link).port;
const before = ["127.0.0.1", "0123456789abcdef.localhost"].map((name) => `http://${name}:${port}/`);
const PAGE = "<!doctype html><title>stolen</title><script>navigator.serviceWorker.register('/worker.js')</script>";
const WORKER = `self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (e) => e.waitUntil(clients.claim()));
self.addEventListener("fetch", (e) => e.respondWith(
  new Response(${JSON.stringify(PAGE)}, { headers: { "content-type": "text/html" } })));`;
const pause = (ms) => new Promise((done) => setTimeout(done, ms));
const live = (page) =>
  page.waitForFunction(() => document.getElementById("link")?.textContent === "live", { timeout: PATIENCE, polling: 200 });
let second = null;
const squat = createServer((asked, answer) => {
  const [kind, text] = asked.url === "/worker.js" ? ["text/javascript", WORKER] : ["text/html", PAGE];
  answer.writeHead(200, { "content-type": kind, "cache-control": "max-age=999999, immutable" }).end(text);
});
/** Tries until it works. */
async function until(what) {
  for (let left = 1000; ; left -= 1) {
    try { return await what(); } catch (e) { if (!left) throw e; }
    await pause(200);
  }
}
const fault = await (async () => {
  const page = await browser.newPage();
  page.setDefaultTimeout(PATIENCE);
  await page.goto(link);
  await live(page);
  await page.goto("about:blank");
  process.kill(daemon.pid, "SIGKILL");
  await until(() => new Promise((done, fail) => squat.once("error", fail).listen(port, "127.0.0.1", done)));
  for (const address of before) {
    await page.goto(address);
    await page.evaluate(() => navigator.serviceWorker.ready.then(() => null));
  }
  squat.closeAllConnections();
  await new Promise((done) => squat.close(done));
  second = spawn(daemon.program, ["watch", "--page", daemon.folder], { stdio: "ignore" });
  const next = await until(() => execFileSync(daemon.program, ["open", "--print", daemon.folder], { stdio: "pipe" }).toString().trim());
  assert.equal(new URL(next).port, port, "the daemon is not back on its port");
  // The trap works: else this would test nothing.
  for (const address of before) {
    await page.goto(address);
    assert.equal(await page.title(), "stolen", address);
  }
  await page.goto(next);
  await live(page);
  assert.equal(await page.title(), "Enfilade");
  assert.ok(!await page.evaluate(() => location.href.includes("key=")), "the key stays in the address");
  const origin = next.split("#")[0];
  await page.goto(`${origin}#key=${"0".repeat(64)}`);
  await page.waitForFunction(() => !location.hash.includes("key="));
  await page.goto("about:blank");
  await page.goto(origin);
  await live(page);
})().catch((e) => e.stack ?? String(e));
second?.kill("SIGKILL");
squat.closeAllConnections();
await browser.close();
if (fault) {
  console.error(fault);
  process.exit(1);
}
process.exit(0);
