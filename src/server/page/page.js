// What the daemon does, live. All names come from files: they become text, never markup.
import { Locked, arrive, lead, signed } from "/login.js";
import { listen } from "/news.js";
import { keeping, newer, showOptions } from "/options.js";

export const $ = (id) => document.getElementById(id);

/** Control characters, and those that turn the direction of writing, as what they are: as the daemon's notices have them. */
export const plain = (text) => text.replace(/[\p{Cc}\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/gu,
  (c) => (c === "\n" || c === "\t" ? c : `\\u{${c.codePointAt(0).toString(16)}}`));

/** An element with attributes and children; strings become text. */
export function el(name, attributes = {}, ...children) {
  const out = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) out.addEventListener(key.slice(2), value);
    else if (value === true) out.setAttribute(key, "");
    else if (value !== false && value != null) out.setAttribute(key, typeof value === "string" ? plain(value) : value);
  }
  out.append(...children.filter((c) => c != null).map((c) => (typeof c === "string" ? plain(c) : c)));
  return out;
}

/** A name, in a direction of its own. */
export const name = (text) => el("bdi", {}, text);

export const say = (text) => { $("said").textContent = plain(text); };

/** Why nothing came of a request; said already. */
class Refusal extends Error {}
addEventListener("unhandledrejection", (e) => { if (e.reason instanceof Refusal) e.preventDefault(); });

const [LIVE, AWAY, LOCKED] = ["live", "the daemon is out of reach; trying again",
  "this browser is not known to the daemon: `enfilade open DIR` shows its page"];
function link(text) {
  if ($("link").textContent !== text) $("link").textContent = text;
}

/** Why the daemon gave no answer. An order that it may have had is not called undone. */
function silence(isOrder) {
  if (!isOrder) return "the daemon is out of reach";
  return $("link").textContent === LIVE ? "the daemon gave no answer; whether it was done shows once it is back"
    : "nothing was done: the daemon is out of reach";
}

/** Asks the interface; a refusal is said and thrown. */
export async function ask(path, body) {
  const isOrder = body !== undefined;
  const options = isOrder ? { method: "POST", body: JSON.stringify(body), headers: { "X-Enfilade": "1" } } : {};
  // What is said twice would not be read twice.
  if (isOrder) say("");
  const fail = (why) => {
    say(why);
    throw new Refusal(why);
  };
  const locked = () => {
    link(LOCKED);
    fail((isOrder ? "nothing was done: " : "") + LOCKED);
  };
  const answer = await signed("/api/" + path, options).catch((e) => (e instanceof Locked ? locked() : fail(silence(isOrder))));
  if (answer.status === 403) locked();
  const text = await answer.text().catch(() => fail(silence(isOrder)));
  if (!answer.ok) fail(text.startsWith("{") ? JSON.parse(text).error : text);
  return JSON.parse(text);
}

const STATES = { waiting: "waits", running: "being worked on", done: "done", failed: "failed", stopped: "stopped" };
/** Stages in words; the others are words already. While files are written nothing is counted. */
const STAGES = { read: "reading", measure: "measuring the present layout", works: "measuring building works", write: "writing the results", "so-far": "writing the best so far" };
/** The card of a running job is not made anew more often. */
const PAUSE_MS = 500;
const drawings = new Map();
let isLoaded = false;
let shown = null;
let detail = 0;

function row(d) {
  const words = STATES[d.state] ?? d.state;
  const p = d.progress;
  const part = STAGES[p?.stage] ? `: ${STAGES[p.stage]}` : p?.total ? ` ${Math.round(100 * p.done / p.total)} %` : "";
  const place = places.get(d.id);
  const show = () => { if (location.hash === "#" + d.id) toTitle(); };
  return el("li", {}, el("a", { href: "#" + d.id, "aria-current": d.id === shown ? "page" : false, onclick: show },
    name(d.name), place == null ? null : el("small", { class: "place" }, name(place)),
    el("small", { class: d.state }, words + part)));
}

const rows = new Map();
/** Of drawings whose name others have too: what tells their folders apart. */
const places = new Map();
const order = new Intl.Collator(undefined, { numeric: true });

/** What differs in folders, from the first part that does; where one lies above the others, from its own name. */
function differing(folders) {
  const parts = folders.map((f) => f.split(/[\\/]/));
  const least = Math.min(...parts.map((p) => p.length));
  let same = 0;
  while (same < least && parts.every((p) => p[same] === parts[0][same])) same += 1;
  if (same === least) same -= 1;
  return parts.map((p) => p.slice(Math.max(0, same)).join("/"));
}

function list() {
  const sorted = [...drawings.values()].sort((a, b) => order.compare(a.name, b.name) || order.compare(a.folder, b.folder));
  places.clear();
  for (const alike of Map.groupBy(sorted, (d) => d.name).values()) {
    const folders = alike.length > 1 ? differing(alike.map((d) => d.folder)) : [];
    folders.forEach((f, i) => places.set(alike[i].id, f));
  }
  // Whoever works by keyboard stays on the same row.
  const held = $("drawings").contains(document.activeElement) ? document.activeElement.hash.slice(1) : null;
  rows.clear();
  sorted.forEach((d) => rows.set(d.id, row(d)));
  $("drawings").replaceChildren(...rows.values());
  rows.get(held)?.firstChild.focus({ preventScroll: true });
  if (!sorted.length) $("drawings").replaceChildren(el("li", { class: "quiet" }, "No drawing yet: save one into a watched folder."));
}

function curve(points) {
  const of = (stage) => points.filter((p) => p[0] === stage);
  // One point is no course: a short search says little in its last stage.
  const stage = points.findLast((p) => of(p[0]).length > 1)?.[0];
  if (!stage) return null;
  const own = of(stage);
  const [xs, ys] = [own.map((p) => p[1]), own.map((p) => p[2])];
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const at = (p) => `${10 + 580 * (p[1] - x0) / (x1 - x0 || 1)},${150 - 140 * (p[2] - y0) / (y1 - y0 || 1)}`;
  const ns = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(ns, "svg");
  svg.setAttribute("viewBox", "0 0 600 160");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `Convergence of ${stage}: from ${ys[0].toPrecision(4)} to ${ys.at(-1).toPrecision(4)} in ${x1} layouts`);
  const line = document.createElementNS(ns, "polyline");
  line.setAttribute("points", own.map(at).join(" "));
  line.setAttribute("fill", "none");
  line.setAttribute("stroke", "currentColor");
  line.setAttribute("stroke-width", "2");
  svg.append(line);
  return el("figure", {}, svg, el("figcaption", { class: "quiet" }, svg.getAttribute("aria-label")));
}

/** Another round as the settings say; options pinned in the round that is shown stay. */
function another(id) {
  const asked = keeping(id);
  const stay = asked.pin ? `; these stay: ${asked.pin.join(", ")}` : "; where nothing has changed it finds the same options";
  return ask(`drawings/${id}/again`, asked).then(() => say(`another round is asked for, as the settings say${stay}`));
}

function standing(d) {
  const p = d.progress;
  // What a finished job said is of the round before.
  const isBusy = d.state === "running" || d.state === "waiting";
  const out = el("div", { class: "card", id: "standing" }, el("p", { class: d.state }, STATES[d.state] ?? d.state,
    d.summary && !isBusy ? `: ${d.summary}` : ""));
  if (d.problem) out.append(el("p", { class: d.problem.severity === "info" ? "note" : "problem" }, `${d.problem.place}: ${d.problem.text}`));
  if (p) {
    const best = p.best == null ? "" : `, best ${p.best.toPrecision(4)}`;
    const left = p.eta_secs == null ? "" : `, ${Math.ceil(p.eta_secs)} s left`;
    const writes = STAGES[p.stage];
    const bar = el("progress", { "aria-label": writes ?? p.stage, max: p.total ?? 1 });
    if (p.total && !writes) bar.value = p.done;
    out.append(el("p", {}, writes ?? `${p.stage}: ${p.evaluations} layouts${best}${left}`), bar);
  }
  if (d.curve) out.append(curve(d.curve) ?? "");
  out.append(el("div", { class: "bar" },
    el("button", { id: "cancel", disabled: !isBusy, onclick: () => ask(`drawings/${d.id}/cancel`, {}).then(() => say("cancelling; what was found so far is written first")) }, "Cancel"),
    el("button", { id: "again", disabled: isBusy, onclick: () => another(d.id) }, "Another round")));
  return out;
}

/** The head of the chosen drawing in view: on a phone it lies below the whole list. */
function toTitle() {
  const title = $("title") ?? $("main");
  title.focus({ preventScroll: true });
  title.scrollIntoView({ block: "start" });
}

const head = (d) => [el("h2", { id: "title", tabindex: -1 }, name(d.name)), el("p", { class: "quiet" }, name(d.folder))];

/** Where whoever works by keyboard was when a card was made anew; it may be made anew once more before he is back. */
let held = null;

async function open(id) {
  shown = id;
  list();
  const main = $("main");
  const turn = ++detail;
  if (!drawings.has(id)) {
    const choice = drawings.size ? ": choose from the list." : ".";
    if (id && isLoaded) main.replaceChildren(el("h2", { id: "title", tabindex: -1 }, "No such drawing"),
      el("p", {}, "Nothing that is watched now has this address" + choice));
    return;
  }
  const d = await ask(`drawings/${id}`).catch((why) => {
    if (turn === detail) main.replaceChildren(...head(drawings.get(id)), el("p", { class: "problem" }, `Not shown: ${why.message}.`));
    throw why;
  });
  if (turn !== detail) return;
  // Whoever works by keyboard stays where the same button is again, else at the head.
  if (main.contains(document.activeElement)) held = document.activeElement.id;
  main.replaceChildren(...head(d), standing(d));
  await below(main, d);
  if (turn !== detail) return;
  const again = held && $(held);
  if (held !== null && document.activeElement === document.body) (again && !again.disabled ? again : $("title")).focus({ preventScroll: true });
  held = null;
}

/** The report of the newest round, and the picture of what was understood. */
function papers(d) {
  const leads = [];
  const to = (path, words) => leads.push(lead(el("a", { target: "_blank", rel: "noopener" }, words), "href", `/api/drawings/${d.id}/${path}`));
  const newest = d.sets.findLast((s) => s.startsWith("round-"));
  if (newest) to(`${newest}/report.html`, `Report of round ${Number(newest.slice(6))}`);
  if (d.sets.includes("analysis")) to("analysis/check.png", "What was understood");
  return leads.length ? el("p", { class: "bar", id: "papers" }, ...leads) : "";
}

/** What is known of a drawing, below its state: options, or the present layout. */
async function below(main, d) {
  main.append(papers(d));
  const found = d.sets.filter((s) => s.startsWith("round-") || s === "so-far");
  if (found.length) await showOptions(main, d, found);
  else if (d.sets.includes("analysis")) {
    main.append(el("h3", {}, "The present layout"));
    const maps = (await ask(`drawings/${d.id}/analysis`)).filter((n) => n.endsWith(".png") && n !== "check.png");
    main.append(el("div", { class: "maps" }, ...maps.map((n) => el("figure", {},
      lead(el("img", { alt: `Heat map of ${n.slice(0, -4)}, as drawn` }), "src", `/api/drawings/${d.id}/analysis/${encodeURIComponent(n)}`),
      el("figcaption", {}, n.slice(0, -4))))));
  }
}

/** A running job changes only its own card, but for the buttons, so that nobody loses the focus. */
let [refreshed, later] = [0, 0];
async function refresh(d, before) {
  if (d.id !== shown) return;
  const wait = refreshed + PAUSE_MS - Date.now();
  if (d.state === before && wait > 0) {
    // What is said last counts: nothing may follow it for long.
    later ||= setTimeout(() => {
      later = 0;
      const now = drawings.get(shown);
      if (now) refresh(now, now.state);
    }, wait);
    return;
  }
  refreshed = Date.now();
  if (d.state === "running" && before === "running" && $("standing")) {
    const full = await ask(`drawings/${d.id}`);
    if (full.id !== shown || full.state !== "running" || !$("standing")) return;
    const [bar, fresh] = [$("standing").lastElementChild, standing(full)];
    fresh.lastElementChild.remove();
    // The buttons stay where they are: what is taken out and put back has lost the focus.
    while (bar.previousSibling) bar.previousSibling.remove();
    bar.before(...fresh.childNodes);
    if (full.so_far != null && !$("options")) await open(full.id);
    else newer(full);
  } else if (d.state !== before) await open(d.id);
}

/** What is watched, and what is left alone with the reason. */
function folders(found) {
  $("roots").replaceChildren(...found.roots.flatMap((r, i) => [i ? "; " : "", name(r.root), `: ${r.how}`]));
  const n = found.ignored_count;
  $("left-title").textContent = n ? `Left alone: ${n} ${n === 1 ? "file" : "files"}` : "Left alone: no file";
  const more = n - found.ignored.length;
  $("left-files").replaceChildren(...found.ignored.map((f) => el("li", {}, name(f.file), el("small", {}, f.why))),
    ...(more > 0 ? [el("li", {}, `and ${more} more; the log has the newest`)] : []));
  $("left-rules").replaceChildren(...found.ignore_rules.map((r) => el("li", {}, el("code", {}, r.glob), el("small", {}, r.why))));
}

/** Files come by the hundred: the lists are asked for once they have. */
let asked = 0;
function soonFolders() {
  asked ||= setTimeout(async () => {
    asked = 0;
    folders(await ask("drawings"));
  }, PAUSE_MS);
}

function logLine(line) { return el("li", {}, `${line.time} ${line.text}`); }

async function load() {
  const [found, log] = await Promise.all([ask("drawings"), ask("log")]);
  drawings.clear();
  found.drawings.forEach((d) => drawings.set(d.id, d));
  isLoaded = true;
  folders(found);
  $("log").replaceChildren(...log.reverse().map(logLine));
  list();
  await open(location.hash.slice(1) || busiest());
}

/** Where nothing is chosen, what is worked on is shown, else what waits, else the only drawing. */
function busiest() {
  const all = [...drawings.values()];
  const first = all.find((d) => d.state === "running") ?? all.find((d) => d.state === "waiting");
  const id = (first ?? (all.length === 1 ? all[0] : null))?.id ?? "";
  if (id) history.replaceState(null, "", "#" + id);
  return id;
}

const stale = new Set();
/** Only rows with news are made anew: focus and place stay, and thousands of others cost nothing. */
function soon(id) {
  if (!stale.size) setTimeout(renew, 200);
  stale.add(id);
}

/** Whoever looks at another drawing keeps what is open, typed and filtered there. */
function gone(id) {
  drawings.delete(id);
  soon(id);
  if (id === shown) open(id);
}

function renew() {
  const ids = [...stale];
  stale.clear();
  if (ids.some((id) => drawings.has(id) !== rows.has(id))) return list();
  for (const id of ids.filter((id) => drawings.has(id))) {
    const fresh = row(drawings.get(id));
    rows.get(id).firstChild.replaceChildren(...fresh.firstChild.childNodes);
  }
}

function hear(news) {
  const { kind, drawing, line, id } = news;
  if (kind === "live") {
    link(LIVE);
    return load();
  }
  if (kind === "away") return link(AWAY);
  if (kind === "locked") return link(LOCKED);
  if (kind === "reload") return load();
  if (kind === "folders") return soonFolders();
  if (kind === "gone") return gone(id);
  if (kind === "log") {
    $("log").prepend(logLine(line));
    while ($("log").childElementCount > 500) $("log").lastElementChild.remove();
    return;
  }
  const before = drawings.get(drawing.id)?.state;
  drawings.set(drawing.id, drawing);
  soon(drawing.id);
  if (!shown && drawing.state === "running") open(busiest());
  else refresh(drawing, before);
}

addEventListener("hashchange", () => {
  // A link that was opened again brings the key of a daemon that has another by now.
  if (location.hash.startsWith("#key=")) arrive().then(load);
  else open(location.hash.slice(1)).finally(toTitle);
});
await arrive();
listen(hear);
