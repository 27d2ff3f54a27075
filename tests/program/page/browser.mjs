// The browser that the tests of the page drive.
import { createRequire } from "node:module";

const puppeteer = createRequire(process.env.NODE_PATH + "/")("puppeteer-core");

/** How long anything may take, ms: jobs stand back for whatever else the machine does, so that it says nothing here. */
export const PATIENCE = 900000;

/** A browser without a window that speaks to nobody by itself. */
export const launch = () => puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  headless: true,
  // Waiting is a call, too: by itself one may take 180 s, however patient the page is.
  protocolTimeout: PATIENCE,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
