// What the daemon does, live. All names come from files: they become text, never markup.
import { showOptions } from "/options.js";

export const $ = (id) => document.getElementById(id);

/** An element with attributes and children; strings become text. */
export function el(name, attributes = {}, ...children) {
  const out = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) out.addEventListener(key.slice(2), value);
    else if (value === true) out.setAttribute(key, "");
    else if (value !== false && value != null) out.setAttribute(key, value);
  }
  out.append(...children.filter((c) => c != null));
  return out;
}

export const say = (text) => { $("said").textContent = text; };

/** Asks the interface; a refusal is said and thrown. */
export async function ask(path, body) {
  const options = body === undefined ? {} :
    { method: "POST", body: JSON.stringify(body), headers: { "X-Enfilade": "1" } };
  const answer = await fetch("/api/" + path, options);
  if (!answer.ok) {
    const text = await answer.text();
    const why = text.startsWith("{") ? JSON.parse(text).error : text;
    say(why);
    throw new Error(why);
  }
  return answer.json();
}

const STATES = { waiting: "waits", running: "being worked on", done: "done", failed: "failed", stopped: "stopped" };
/** Stages in words; the others are words already. While files are written nothing is counted. */
const STAGES = { read: "reading", write: "writing the results", "so-far": "writing the best so far" };
/** The card of a running job is not made anew more often. */
const PAUSE_MS = 500;
const drawings = new Map();
let shown = null;
let detail = 0;

function row(d) {
  const words = STATES[d.state] ?? d.state;
  const p = d.progress;
  const part = STAGES[p?.stage] ? `: ${STAGES[p.stage]}` : p?.total ? ` ${Math.round(100 * p.done / p.total)} %` : "";
  return el("li", {}, el("a", { href: "#" + d.id, "aria-current": d.id === shown ? "page" : false },
    d.name, el("small", { class: d.state }, words + part)));
}

const rows = new Map();
const order = new Intl.Collator(undefined, { numeric: true });

function list() {
  const sorted = [...drawings.values()].sort((a, b) => order.compare(a.name, b.name));
  rows.clear();
  sorted.forEach((d) => rows.set(d.id, row(d)));
  $("drawings").replaceChildren(...rows.values());
  if (!sorted.length) $("drawings").replaceChildren(el("li", { class: "quiet" }, "No drawing yet: save one into a watched folder."));
}

function curve(points) {
  if (points.length < 2) return null;
  const stage = points.at(-1)[0];
  const own = points.filter((p) => p[0] === stage);
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
    el("button", { id: "cancel", disabled: !isBusy, onclick: () => ask(`drawings/${d.id}/cancel`, {}).then(() => say("cancelling")) }, "Cancel"),
    el("button", { id: "again", disabled: isBusy, onclick: () => ask(`drawings/${d.id}/again`, {}).then(() => say("another round is asked for")) }, "Another round")));
  return out;
}

async function open(id) {
  shown = id;
  list();
  if (!drawings.has(id)) return;
  const turn = ++detail;
  const d = await ask(`drawings/${id}`);
  if (turn !== detail) return;
  const main = $("main");
  main.replaceChildren(el("h2", {}, d.name), el("p", { class: "quiet" }, d.folder), standing(d));
  const rounds = d.sets.filter((s) => s.startsWith("round-"));
  if (rounds.length) await showOptions(main, d, rounds);
  else if (d.sets.includes("analysis")) {
    main.append(el("h3", {}, "The present layout"));
    const maps = (await ask(`drawings/${id}/analysis`)).filter((n) => n.endsWith(".png") && n !== "check.png");
    main.append(el("div", { class: "maps" }, ...maps.map((n) => el("figure", {},
      el("img", { src: `/api/drawings/${id}/analysis/${encodeURIComponent(n)}`, alt: `Heat map of ${n.slice(0, -4)}, as drawn` }),
      el("figcaption", {}, n.slice(0, -4))))));
  }
}

/** A running job changes only its own card, so that nobody loses the focus. */
let refreshed = 0;
async function refresh(d, before) {
  if (d.id !== shown) return;
  if (d.state === before && Date.now() - refreshed < PAUSE_MS) return;
  refreshed = Date.now();
  if (d.state === "running" && before === "running" && $("standing")) {
    const full = await ask(`drawings/${d.id}`);
    if (full.id !== shown || !$("standing") || $("standing").contains(document.activeElement)) return;
    $("standing").replaceWith(standing(full));
  } else if (d.state !== before) await open(d.id);
}

/** What is watched, and what is left alone with the reason. */
function folders(found) {
  $("roots").textContent = found.roots.map((r) => `${r.root}: ${r.how}`).join("; ");
  const n = found.ignored_count;
  $("left-title").textContent = n ? `Left alone: ${n} ${n === 1 ? "file" : "files"}` : "Left alone: no file";
  const more = n - found.ignored.length;
  $("left-files").replaceChildren(...found.ignored.map((f) => el("li", {}, f.file, el("small", {}, f.why))),
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
  folders(found);
  $("log").replaceChildren(...log.reverse().map(logLine));
  list();
  const id = location.hash.slice(1);
  if (id) await open(id);
}

const stale = new Set();
/** Only rows with news are made anew: focus and place stay, and thousands of others cost nothing. */
function soon(id) {
  if (!stale.size) setTimeout(renew, 200);
  stale.add(id);
}

function renew() {
  const ids = [...stale].filter((id) => drawings.has(id));
  stale.clear();
  if (ids.some((id) => !rows.has(id))) return list();
  for (const id of ids) {
    const fresh = row(drawings.get(id));
    rows.get(id).firstChild.replaceChildren(...fresh.firstChild.childNodes);
  }
}

function listen() {
  const news = new EventSource("/api/events");
  news.onopen = () => { $("link").textContent = "live"; load(); };
  news.onerror = () => { $("link").textContent = "the daemon is out of reach; trying again"; };
  news.onmessage = (message) => {
    const { kind, drawing, line } = JSON.parse(message.data);
    if (kind === "reload") return load();
    if (kind === "folders") return soonFolders();
    if (kind === "log") {
      $("log").prepend(logLine(line));
      while ($("log").childElementCount > 500) $("log").lastElementChild.remove();
      return;
    }
    const before = drawings.get(drawing.id)?.state;
    drawings.set(drawing.id, drawing);
    soon(drawing.id);
    refresh(drawing, before);
  };
}

addEventListener("hashchange", async () => {
  await open(location.hash.slice(1));
  $("main").focus();
});
listen();
