// One stream of news for all tabs: a browser opens six connections to a page, and each stream holds one. The tab that has
// the lock listens and tells the others; when it goes, the next one has the lock.
import { Locked, greet, signed } from "/login.js";

/** After this long it is tried again. */
const RETRY_MS = 3_000;
const channel = new BroadcastChannel("enfilade-news");
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** Calls `on` with each piece of news: those of the daemon, and how it is with it: `live`, `away`, `locked`. */
export function listen(on) {
  let [state, isFirst] = [null, false];
  const tell = (news) => {
    if (["live", "away", "locked"].includes(news.kind)) state = news;
    on(news);
    channel.postMessage(news);
  };
  channel.onmessage = ({ data }) => {
    if (data.kind !== "who") on(data);
    else if (isFirst && state) channel.postMessage(state);
  };
  channel.postMessage({ kind: "who" });
  navigator.locks.request("enfilade-news", async () => {
    isFirst = true;
    for (;;) {
      await hear(tell).catch((e) => tell({ kind: e instanceof Locked ? "locked" : "away" }));
      await pause(RETRY_MS);
    }
  });
}

/** Reads the stream until it ends. */
async function hear(tell) {
  await greet();
  const answer = await signed("/api/events");
  if (answer.status === 403) throw new Locked();
  if (!answer.ok) throw new Error("too many listen");
  tell({ kind: "live" });
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) throw new Error("the stream has ended");
    const parts = (rest + value).split("\n\n");
    rest = parts.pop();
    for (const part of parts) {
      const data = part.split("\n").filter((l) => l.startsWith("data:")).map((l) => l.slice(5).trimStart()).join("\n");
      if (data) tell(JSON.parse(data));
    }
  }
}
