// Options side by side: a slider over heat maps, parallel coordinates and a scatter to filter, pin, more like one, accept.
import { lead } from "/login.js";
import { $, ask, el, plain, say } from "/page.js";
import { Parallel, Scatter, onNewLook } from "/plots.js";

const ROWS = 200;
/** Columns of the table; the plots and filters have them all. */
const TABLE_COLUMNS = 12;
/** Table and whole plots are made anew this long after the last change of a filter. */
const PAUSE_MS = 120;
const FIRST = ["score", "degree", "depth", "entropy"];

/** Measures with heat maps: those that lie in the set for the present layout and the options. */
function shownOf(names) {
  const found = names.map((n) => /^initial-(.*)\.png$/.exec(n)?.[1]).filter(Boolean);
  return [...FIRST.filter((m) => found.includes(m)), ...found.filter((m) => !FIRST.includes(m))];
}

/** A measure as axes and columns name it: `clearance_m2` is an area in square metres. */
const named = (key) => key.replace(/_m2$/, ", m²").replace(/_m$/, ", m").replaceAll("_", " ");

const unit = (u) => (u === "deg" ? ", °" : u ? `, ${u}` : "");

/** Columns to compare by: means, penalties, parameters. */
function columnsOf(result) {
  const first = result.candidates[0];
  const means = Object.keys(first.mean).filter((k) => k !== "degree_all");
  const score = first.score == null ? [] : [{ name: "score", of: (c) => c.score }];
  return [...score, ...means.filter((m) => m !== "score").map((m) => ({ name: named(m), of: (c) => c.mean[m] })),
    ...Object.keys(first.penalty).map((p) => ({ name: named(p), of: (c) => c.penalty[p] })),
    ...result.moves.map((m, i) => ({ name: plain(`${m.name} ${m.kind}${unit(m.unit)}`), of: (c) => c.parameters[i] }))]
    .map((column) => {
      const values = result.candidates.map(column.of).filter(Number.isFinite);
      const [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
      return { ...column, low, high, from: low, to: high };
    }).filter((c) => Number.isFinite(c.low));
}

const passes = (columns) => {
  const narrowed = columns.filter((k) => k.from > k.low || k.to < k.high);
  return (c) => narrowed.every((k) => !Number.isFinite(k.of(c)) || (k.of(c) >= k.from && k.of(c) <= k.to));
};

function canvas(label) {
  return el("canvas", { role: "img", "aria-label": label });
}

function pair(d, set, number, measure) {
  const at = (name) => `/api/drawings/${d.id}/${set}/${name}-${encodeURIComponent(measure)}.png`;
  const after = lead(el("img", { alt: `Option ${number}: heat map of ${measure}` }), "src", at(`candidate-${number}`));
  const cut = el("input", { type: "range", min: 0, max: 100, value: 50, "aria-label": "How much of the option is shown over the present layout, per cent" });
  const show = () => { after.style.clipPath = `inset(0 0 0 ${100 - cut.value}%)`; };
  cut.addEventListener("input", show);
  show();
  return el("div", {}, el("div", { class: "pair" }, lead(el("img", { alt: `Present layout: heat map of ${measure}` }), "src", at("initial")), after), cut,
    el("p", { class: "quiet ends" }, el("span", {}, "present layout"), el("span", {}, `option ${number}`)));
}

const staying = (pin) => (pin.length ? `; these stay: ${pin.join(", ")}` : "");

/** How many of the first options this round was told to keep. */
const keptCount = (result) => Math.min(result.settings?.pinned?.length ?? 0, result.candidates.length);

/** What there is to say of an option before its words: whether it was pinned, and what it misses. */
function markOf(result, i) {
  const c = result.candidates[i];
  const breaks = c.explanation?.breaks?.length;
  const parts = [i < keptCount(result) || breaks ? "pinned" : "", breaks ? "breaks a rule" : c.within_threshold ? "" : "below a threshold"];
  const said = parts.filter(Boolean).join("; ");
  return said && ` (${said})`;
}

/** What is wrong with a threshold as it is typed; `null` where nothing is. */
function wrongThreshold(o, text) {
  const n = Number(text);
  if (text.trim() !== "" && n >= 0 && n <= 1) return null;
  return `the threshold of ${o.name}: found ${text.trim() === "" ? "nothing" : text}, expected a share from 0 to 1; nothing was done`;
}

/** The card of the next round; its last line says which options stay. */
function nextRound(d, key, order, result, numbers, isHeld) {
  const rows = (result.objectives ?? []).filter((o) => o.name !== "penalty");
  const typed = typedOf.get(key) ?? {};
  typedOf.set(key, typed);
  const fields = rows.map((o) => {
    const input = el("input", { type: "number", min: 0, max: 1, step: "any", value: typed[o.name] ?? Number(o.threshold.toPrecision(3)) });
    input.addEventListener("input", () => { typed[o.name] = input.value; });
    return { o, input, row: el("label", {}, `${o.name}: share of its optimum that an option must reach`, input) };
  });
  const stays = el("p", { id: "stays" });
  const go = () => {
    const wrong = fields.find((f) => wrongThreshold(f.o, f.input.value));
    if (wrong) {
      say(wrongThreshold(wrong.o, wrong.input.value));
      wrong.input.focus();
      return;
    }
    const objective = fields.map((f) => `${f.o.name} ${f.o.sense} ${f.input.value}`).join(", ");
    const asked = { objective: objective || null, ...order, pin: numbers() };
    ask(`drawings/${d.id}/again`, asked).then((a) => say(`another round is asked for: ${a.objective}${staying(asked.pin)}`));
  };
  const card = el("details", { class: "card" }, el("summary", {}, "Another round with other thresholds or pinned options"),
    el("fieldset", {}, el("legend", {}, "Thresholds, from 0 to 1"), ...fields.map((f) => f.row)), stays,
    el("div", { class: "bar" }, el("button", { id: "again-with", disabled: isHeld, onclick: go }, "Start this round")));
  card.open = typed.isOpen ?? false;
  card.addEventListener("toggle", () => { typed.isOpen = card.open; });
  const show = () => {
    stays.textContent = numbers().length ? `Pinned options stay, and others unlike them are found: ${numbers().join(", ")}.`
      : "No option is pinned: pin those that the next round is to keep.";
  };
  show();
  return { card: fields.length ? card : "", show };
}

/** What one building work would bring: where there is no option, that is what the round has to say. */
function works(result) {
  const said = result.problems.filter((p) => p.code.startsWith("work"));
  if (!said.length) return null;
  return el("section", {}, el("h3", {}, "What one building work would bring"),
    el("ul", {}, ...said.map((p) => el("li", {}, p.text))));
}

function problems(result) {
  const others = result.problems.filter((p) => !p.code.startsWith("work"));
  if (!others.length) return null;
  const rows = others.map((p) => el("tr", {}, el("td", {}, p.severity), el("td", {}, p.place), el("td", {}, p.text)));
  return el("details", { class: "card" }, el("summary", {}, `Problems and assumptions (${rows.length})`),
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Problems" }, el("table", {},
      el("thead", {}, el("tr", {}, ...["Weight", "Where", "What"].map((t) => el("th", { scope: "col" }, t)))), el("tbody", {}, ...rows))));
}

/** Numbers of the pinned options by drawing and round: they outlive that the page is drawn anew. */
const pinsOf = new Map();
/** The option and the measure that are shown, by drawing and round: they outlive it too. */
const viewOf = new Map();
/** What is typed for another round, by drawing and round, and whether its card is open: it outlives it as well. */
const typedOf = new Map();
/** What is shown of a drawing: its set, the key of its pins, what it is in orders; and the newest set then: a newer one
 * takes its place. */
const roundOf = new Map();

/** What the best so far is called: no round yet. */
const SO_FAR = "so-far";
const titleOf = (set) => (set === SO_FAR ? "Best so far" : `Round ${Number(set.slice(6))}`);
/** How an order names the options of a set; those of the best so far change with the layouts that it was found in. */
const orderOf = (set, result) => (set === SO_FAR ? { so_far: result.evaluations } : { round: Number(set.slice(6)) });
const keyOf = (d, set, result) => `${d.id}/${set}${set === SO_FAR ? `/${result.evaluations}` : ""}`;

/** What another round of a drawing is asked with where options of the round shown are pinned. */
export function keeping(id) {
  const at = roundOf.get(id);
  const pin = pinsOf.get(at?.key) ?? [];
  return pin.length ? { ...at.order, pin } : {};
}

/** Offers the best so far anew where the search has found another since. */
export function newer(d) {
  const at = roundOf.get(d.id);
  const button = $("newer");
  if (button && at?.set === SO_FAR) button.hidden = d.so_far == null || d.so_far === at.order?.so_far;
}

/** Shows the newest round, or another that was chosen since it came, and a choice of the others; the best so far of a
 * search that was stopped, or where there is no round. */
export async function showOptions(main, d, sets) {
  const rounds = [...sets.filter((s) => s === SO_FAR), ...sets.filter((s) => s !== SO_FAR)];
  const newest = d.state === "stopped" && sets.includes(SO_FAR) ? SO_FAR : rounds.at(-1);
  const before = roundOf.get(d.id);
  const set = before?.newest === newest && rounds.includes(before.set) ? before.set : newest;
  const again = el("button", { id: "newer", hidden: true, onclick: () => show(SO_FAR) }, "Show what was found since");
  const place = el("div", { id: "options" });
  const show = (set) => {
    roundOf.set(d.id, { set, newest });
    again.hidden = true;
    return round(place, d, set);
  };
  const choice = el("select", { id: "round", onchange: () => show(choice.value) },
    ...rounds.toReversed().map((r) => el("option", { value: r, selected: r === set }, titleOf(r))));
  main.append(el("div", { class: "bar" }, el("label", { for: "round" }, "Shown"), choice, again), place);
  await show(set);
}

async function round(place, d, set) {
  const [result, names] = await Promise.all([ask(`drawings/${d.id}/${set}/result.json`), ask(`drawings/${d.id}/${set}`)]);
  const [key, order] = [keyOf(d, set, result), orderOf(set, result)];
  if (roundOf.get(d.id)?.set === set) Object.assign(roundOf.get(d.id), { key, order });
  if (!result.candidates.length) {
    place.replaceChildren(el("p", {}, `No option: ${result.stopped_by}.`), works(result) ?? "", problems(result) ?? "");
    return;
  }
  const [columns, shown] = [columnsOf(result), shownOf(names)];
  const view = viewOf.get(key);
  let [chosen, measure, axes] = [Math.min(view?.chosen ?? 0, result.candidates.length - 1),
    shown.includes(view?.measure) ? view.measure : shown[0], [columns[0], columns[1] ?? columns[0]]];
  const pinned = new Set((pinsOf.get(key) ?? []).map((n) => result.candidates[n - 1]).filter(Boolean));
  const numbers = () => [...pinned].map((c) => result.candidates.indexOf(c) + 1).sort((a, b) => a - b);
  // While the search goes on its best so far changes: an order could mean another option.
  const isHeld = set === SO_FAR && (d.state === "running" || d.state === "waiting");
  // Works are kept by accepting them: only moves are pinned, or searched near.
  const isBound = (c) => isHeld || c.works?.length > 0;
  const next = nextRound(d, key, order, result, numbers, isHeld);
  const views = [canvas("Parallel coordinates of the options; the filters and the table below have the same numbers"),
    canvas("Scatter of the options; the table below has the same numbers")];
  const lines = new Parallel(views[0], columns, soon, () => { showRanges(); soon(); });
  const dots = new Scatter(views[1], (c) => choose(result.candidates.indexOf(c)));
  const picture = el("div", { id: "picture" });
  const words = el("p", { id: "words" });
  const deeds = {
    pin: el("button", { id: "chosen-pin", onclick: () => pin(result.candidates[chosen]) }),
    like: el("button", { id: "chosen-like", onclick: () => like(chosen) }),
    accept: el("button", { id: "chosen-accept", disabled: isHeld, onclick: () => accept(chosen) }),
  };
  const body = el("tbody");
  const count = el("p", { role: "status" });
  const isMarked = (c) => c === result.candidates[chosen] || pinned.has(c);
  let [kept, frame, pause] = [result.candidates, 0, 0];

  function pictures() {
    const c = result.candidates[chosen];
    viewOf.set(key, { chosen, measure });
    words.textContent = plain(`Option ${chosen + 1}${markOf(result, chosen)}: ${c.words}`);
    deeds.pin.textContent = `Pin option ${chosen + 1}`;
    deeds.like.textContent = `More like option ${chosen + 1}`;
    deeds.accept.textContent = `Accept option ${chosen + 1}`;
    deeds.pin.disabled = deeds.like.disabled = isBound(c);
    deeds.pin.setAttribute("aria-pressed", String(pinned.has(c)));
    picture.replaceChildren(shown.length ? pair(d, set, chosen + 1, measure) : "");
  }
  function choose(i) {
    chosen = i;
    pictures();
    compare();
  }
  function pin(c) {
    if (!pinned.delete(c)) pinned.add(c);
    pinsOf.set(key, numbers());
    next.show();
    deeds.pin.setAttribute("aria-pressed", String(pinned.has(result.candidates[chosen])));
    compare();
  }
  function accept(i) {
    ask(`drawings/${d.id}/accept`, { ...order, candidate: i + 1 })
      .then((a) => say(`option ${i + 1} is now ${a.drawing}`));
  }
  function like(i) {
    const pin = numbers();
    ask(`drawings/${d.id}/again`, { ...order, pin, like: i + 1 })
      .then(() => say(`another round is asked for, with more like option ${i + 1}${staying(pin)}`));
  }
  function plots(isQuick) {
    kept = result.candidates.filter(passes(columns));
    count.textContent = `${kept.length} of ${result.candidates.length} options` + (kept.length > ROWS ? `, the first ${ROWS} listed` : "");
    lines.draw(kept, isMarked, isQuick);
    dots.draw(axes, kept, isMarked, isQuick);
  }
  function table() {
    const first = kept.toSorted((a, b) => pinned.has(b) - pinned.has(a)).slice(0, ROWS);
    const focus = document.activeElement?.id;
    body.replaceChildren(...first.map((c) => {
      const i = result.candidates.indexOf(c);
      return el("tr", { class: pinned.has(c) ? "pinned" : "" },
        el("th", { scope: "row" }, String(i + 1), i < keptCount(result) ? el("small", {}, " pinned before") : null),
        el("td", {}, el("div", { class: "bar" },
          el("button", { id: `show-${i}`, "aria-pressed": String(i === chosen), onclick: () => choose(i) }, `Show ${i + 1}`),
          el("button", { id: `pin-${i}`, disabled: isBound(c), "aria-pressed": String(pinned.has(c)), onclick: () => pin(c) }, `Pin ${i + 1}`),
          el("button", { id: `like-${i}`, disabled: isBound(c), onclick: () => like(i) }, `More like ${i + 1}`),
          el("button", { id: `accept-${i}`, disabled: isHeld, onclick: () => accept(i) }, `Accept ${i + 1}`),
          lead(el("a", {}, `File ${i + 1}`), "href", `/api/drawings/${d.id}/${set}/${encodeURIComponent(c.file)}`))),
        ...columns.slice(0, TABLE_COLUMNS).map((k) => el("td", {}, Number.isFinite(k.of(c)) ? k.of(c).toPrecision(4) : "–")));
    }));
    if (focus) $(focus)?.focus();
  }
  function compare() {
    plots(false);
    table();
  }
  /** While a range is drawn: the plots in outline at the next frame, everything after a pause. */
  function soon() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(() => plots(true));
    clearTimeout(pause);
    pause = setTimeout(compare, PAUSE_MS);
  }
  const pick = (id, label, options, value, change) => [el("label", { for: id }, label),
    el("select", { id, onchange: (e) => change(e.target.value) }, ...options.map((o, i) => el("option", { value: i, selected: i === value }, o)))];
  const titles = columns.map((k) => k.name);
  const ranges = [];
  const filter = (k, side, label) => {
    const shown = () => Number(k[side].toPrecision(5));
    const input = el("input", { type: "number", step: "any", value: shown(), "aria-label": `${k.name} ${label}`, onchange: (e) => {
      k[side] = Number.isFinite(e.target.valueAsNumber) ? e.target.valueAsNumber : k[side === "from" ? "low" : "high"];
      compare();
    } });
    ranges.push(() => { input.value = shown(); });
    return el("label", {}, label, input);
  };
  const showRanges = () => ranges.forEach((show) => show());
  const everything = () => {
    columns.forEach((k) => { [k.from, k.to] = [k.low, k.high]; });
    showRanges();
    compare();
  };
  place.replaceChildren(
    isHeld ? el("p", { class: "note", id: "held" }, "The search goes on, and this list changes with it. Cancel it to take one of these: they stay.") : "",
    el("div", { class: "card" }, words, el("div", { class: "bar" }, deeds.pin, deeds.like, deeds.accept), shown.length ? el("div", { class: "bar" },
      ...pick("measure", "Heat map of", shown, shown.indexOf(measure), (v) => { measure = shown[v]; pictures(); })) : "", picture),
    el("h3", {}, "Compare"), count, views[0],
    el("p", { class: "quiet" }, "Draw along an axis to keep a range; click the axis to take it off."),
    el("div", { class: "bar" }, ...pick("scatter-x", "Across", titles, 0, (v) => { axes = [columns[v], axes[1]]; compare(); }),
      ...pick("scatter-y", "Up", titles, Math.min(1, titles.length - 1), (v) => { axes = [axes[0], columns[v]]; compare(); })), views[1],
    el("details", { class: "card" }, el("summary", {}, "Filter by numbers"),
      el("div", { class: "bar" }, el("button", { id: "everything", onclick: everything }, "Take all filters off")),
      el("div", { class: "axes" }, ...columns.map((k) => el("fieldset", {}, el("legend", {}, k.name), filter(k, "from", "at least"), filter(k, "to", "at most"))))),
    el("p", { class: "quiet narrow" }, "The table goes on to the right: scroll it sideways for the numbers."),
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Options" }, el("table", {}, el("thead", {}, el("tr", {},
      ...["Option", "Do", ...titles.slice(0, TABLE_COLUMNS)].map((n) => el("th", { scope: "col" }, n)))), body)),
    next.card, works(result) ?? "", problems(result) ?? "");
  pictures();
  compare();
  onNewLook(views, () => plots(false));
}
