// The browser that the tests of the page drive.
import { createRequire } from "node:module";

const puppeteer = createRequire(process.env.NODE_PATH + "/")("puppeteer-core");

/** A browser without a window that speaks to nobody by itself. */
export const launch = () => puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  headless: true,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
