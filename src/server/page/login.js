// How the page and its daemon know each other. The key comes once behind the # of the link, is kept where no script can
// read it, and is never sent: requests are signed with it, and the daemon proves that it has it too.

const KEY = /^#key=([0-9a-f]{64})$/;
/** The daemon has not our key, or we have none: `enfilade open` brings it. */
export class Locked extends Error {}

const bytes = (text) => new TextEncoder().encode(text);
const hex = (data) => Array.from(new Uint8Array(data), (b) => b.toString(16).padStart(2, "0")).join("");
const fresh = () => hex(crypto.getRandomValues(new Uint8Array(16)));

/** A place of this address alone, its port included; without one, as in some private windows, the key lasts as long as the page. */
function shelf(mode, work) {
  return new Promise((done, fail) => {
    const opening = indexedDB.open("enfilade", 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore("keys");
    opening.onerror = () => fail(opening.error);
    opening.onsuccess = () => {
      const asked = work(opening.result.transaction("keys", mode).objectStore("keys"));
      asked.onsuccess = () => { opening.result.close(); done(asked.result); };
      asked.onerror = () => fail(asked.error);
    };
  });
}

let key = null;
/** The word by which this start of the daemon is signed for. */
let start = null;

/** The key of a link that was followed: it takes the place of the other once the daemon has proved that it has it. */
let offered = null;

const keyOf = (text) =>
  crypto.subtle.importKey("raw", bytes(text), { name: "HMAC", hash: "SHA-256" }, false, ["sign", "verify"]);

/** Takes the key out of the address, before anything else is asked. */
export async function arrive() {
  const found = KEY.exec(location.hash);
  if (!found) return;
  history.replaceState(null, "", location.pathname);
  [offered, start] = [await keyOf(found[1]), null];
  await greet().catch(() => null);
}

const mac = async (text, by = key) => hex(await crypto.subtle.sign("HMAC", by, bytes(text)));

/** The page has no service workers: one that is there was left by a stranger who had the port, and hears all. */
async function alone() {
  const workers = navigator.serviceWorker;
  const left = await workers?.getRegistrations().catch(() => []) ?? [];
  await Promise.all(left.map((worker) => worker.unregister()));
  if (workers?.controller) throw new Locked();
}

/** Greets the daemon. A stranger on its port cannot answer and hears nothing. */
export async function greet() {
  await alone();
  // Another tab may have got a newer key.
  const kept = (await shelf("readonly", (keys) => keys.get("page")).catch(() => null)) ?? key;
  if (!offered && !kept) throw new Locked();
  const nonce = fresh();
  const answer = await fetch(`/api/hello?nonce=${nonce}`);
  const said = answer.ok ? await answer.json().catch(() => ({})) : {};
  const isProved = async (by) => by && said.proof === await mac(`page\n${said.start}\n${nonce}`, by);
  const isOffered = await isProved(offered);
  if (!isOffered && !await isProved(kept)) throw new Locked();
  key = isOffered ? offered : kept;
  start = said.start;
  offered = null;
  if (isOffered) await shelf("readwrite", (keys) => keys.put(key, "page")).catch(() => null);
}

/** A signed request. A daemon that was started again is greeted first. */
export async function signed(address, options = {}) {
  for (let turn = 0; ; turn += 1) {
    if (!start || turn) await greet();
    const nonce = fresh();
    const sign = await mac(`${options.method ?? "GET"}\n${start}\n${nonce}\n${address}`);
    const headers = { ...options.headers, Authorization: `Enfilade ${nonce}.${sign}` };
    const answer = await fetch(address, { ...options, headers });
    if (answer.status !== 403 || turn) return answer;
  }
}

/** An address for a picture or a link, good for this one file and this start. */
export async function addressOf(path) {
  if (!start) await greet();
  return `${path}?mac=${await mac(`GET\n${start}\n\n${path}`)}`;
}

/** Sets the address of an element once it is signed. */
export function lead(element, attribute, path) {
  addressOf(path).then((address) => element.setAttribute(attribute, address)).catch(() => null);
  return element;
}
