// Options side by side: a slider over heat maps, parallel coordinates and a scatter to filter, pin, accept.
import { $, ask, el, say } from "/page.js";

const ROWS = 200;
const MEASURES = ["score", "degree", "depth", "entropy"];
const pinned = new Set();

/** Measures with heat maps: those of every round, and what each named pair of regions sees. */
const shownOf = (result) =>
  [...MEASURES, ...Object.keys(result.candidates[0].mean).filter((k) => k.startsWith("degree@"))];

/** Columns to compare by: means, penalties, parameters. */
function columnsOf(result) {
  const first = result.candidates[0];
  const means = Object.keys(first.mean).filter((k) => MEASURES.includes(k) || k.includes("@"));
  const score = first.score == null ? [] : [{ name: "score", of: (c) => c.score }];
  return [...score, ...means.filter((m) => m !== "score").map((m) => ({ name: m, of: (c) => c.mean[m] })),
    ...Object.keys(first.penalty).map((p) => ({ name: p, of: (c) => c.penalty[p] })),
    ...result.moves.map((m, i) => ({ name: `${m.name} ${m.kind}`, of: (c) => c.parameters[i] }))]
    .map((column) => {
      const values = result.candidates.map(column.of).filter(Number.isFinite);
      const [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
      return { ...column, low, high, from: low, to: high };
    }).filter((c) => Number.isFinite(c.low));
}

const passes = (columns) => (c) => columns.every((k) => !Number.isFinite(k.of(c)) || (k.of(c) >= k.from && k.of(c) <= k.to));
const part = (k, c) => (k.of(c) - k.low) / (k.high - k.low || 1);

function canvas(label) {
  return el("canvas", { role: "img", "aria-label": label });
}

function pen(view) {
  const ratio = devicePixelRatio || 1;
  view.width = view.clientWidth * ratio;
  view.height = view.clientHeight * ratio;
  const out = view.getContext("2d");
  out.scale(ratio, ratio);
  out.strokeStyle = out.fillStyle = getComputedStyle(view).color;
  out.font = "12px system-ui";
  return out;
}

function drawParallel(view, columns, kept, chosen) {
  const p = pen(view);
  const [w, h] = [view.clientWidth, view.clientHeight];
  const x = (i) => 40 + (w - 80) * i / Math.max(1, columns.length - 1);
  const y = (k, c) => h - 30 - (h - 60) * part(k, c);
  columns.forEach((k, i) => {
    p.globalAlpha = 0.5;
    p.strokeRect(x(i), 30, 0, h - 60);
    p.globalAlpha = 1;
    if (columns.length <= 8) p.fillText(k.name, Math.max(2, x(i) - 30), 18);
  });
  for (const c of kept) {
    const isMarked = c === chosen || pinned.has(c.file);
    p.globalAlpha = isMarked ? 1 : Math.max(0.03, Math.min(0.6, 60 / kept.length));
    p.lineWidth = isMarked ? 3 : 1;
    p.beginPath();
    columns.forEach((k, i) => p[i ? "lineTo" : "moveTo"](x(i), y(k, c)));
    p.stroke();
  }
}

function drawScatter(view, [a, b], kept, chosen) {
  const p = pen(view);
  const [w, h] = [view.clientWidth, view.clientHeight];
  p.fillText(`${b.name} ↑  ${a.name} →`, 6, 14);
  for (const c of kept) {
    const isMarked = c === chosen || pinned.has(c.file);
    p.globalAlpha = isMarked ? 1 : 0.5;
    p.beginPath();
    p.arc(20 + (w - 40) * part(a, c), h - 20 - (h - 50) * part(b, c), isMarked ? 7 : 4, 0, 7);
    p.fill();
  }
}

function pair(d, set, number, measure) {
  const at = (name) => `/api/drawings/${d.id}/${set}/${name}-${measure.replace("@", "-")}.png`;
  const after = el("img", { src: at(`candidate-${number}`), alt: `Option ${number}: heat map of ${measure}` });
  const cut = el("input", { type: "range", min: 0, max: 100, value: 50, "aria-label": "How much of the option is shown over the present layout, per cent" });
  const show = () => { after.style.clipPath = `inset(0 0 0 ${100 - cut.value}%)`; };
  cut.addEventListener("input", show);
  show();
  return el("div", {}, el("div", { class: "pair" }, el("img", { src: at("initial"), alt: `Present layout: heat map of ${measure}` }), after), cut);
}

function thresholds(d, result) {
  const rows = (result.objectives ?? []).filter((o) => MEASURES.includes(o.name));
  const fields = rows.map((o) => {
    const input = el("input", { type: "number", min: 0, max: 1, step: 0.05, value: o.threshold });
    return { o, input, row: el("label", {}, `${o.name}: share of its optimum that an option must reach`, input) };
  });
  const go = () => {
    const objective = fields.map((f) => `${f.o.name} ${f.o.sense} ${f.input.value}`).join(", ");
    ask(`drawings/${d.id}/again`, { objective }).then(() => say(`another round is asked for: ${objective}`));
  };
  if (!fields.length) return null;
  return el("details", { class: "card" }, el("summary", {}, "Another round with other thresholds"),
    el("fieldset", {}, el("legend", {}, "Thresholds, from 0 to 1"), ...fields.map((f) => f.row)),
    el("div", { class: "bar" }, el("button", { id: "again-with", onclick: go }, "Start this round")));
}

function problems(result) {
  if (!result.problems.length) return null;
  const rows = result.problems.map((p) => el("tr", {}, el("td", {}, p.severity), el("td", {}, p.place), el("td", {}, p.text)));
  return el("details", { class: "card" }, el("summary", {}, `Problems and assumptions (${rows.length})`),
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Problems" }, el("table", {},
      el("thead", {}, el("tr", {}, ...["", "Where", "What"].map((t) => el("th", { scope: "col" }, t || "Weight")))), el("tbody", {}, ...rows))));
}

/** Shows the newest round, and a choice of the others. */
export async function showOptions(main, d, rounds) {
  const place = el("div", { id: "options" });
  const choice = el("select", { id: "round", onchange: () => round(place, d, choice.value) },
    ...rounds.toReversed().map((r) => el("option", { value: r }, r.replace("-0", " ").replace("-", " "))));
  main.append(el("div", { class: "bar" }, el("label", { for: "round" }, "Round"), choice), place);
  await round(place, d, choice.value);
}

async function round(place, d, set) {
  const result = await ask(`drawings/${d.id}/${set}/result.json`);
  if (!result.candidates.length) {
    place.replaceChildren(el("p", {}, `No option: ${result.stopped_by}.`), problems(result) ?? "");
    return;
  }
  const [columns, shown] = [columnsOf(result), shownOf(result)];
  let [chosen, measure, axes] = [0, "score", [columns[0], columns[1] ?? columns[0]]];
  const [lines, dots] = [canvas("Parallel coordinates of the options; the table below has the same numbers"), canvas("Scatter of the options")];
  const picture = el("div", { id: "picture" });
  const words = el("p", { id: "words" });
  const body = el("tbody");
  const count = el("p", { role: "status" });

  function pictures() {
    const c = result.candidates[chosen];
    words.textContent = `Option ${chosen + 1}${c.within_threshold ? "" : " (below a threshold)"}: ${c.words}`;
    picture.replaceChildren(pair(d, set, chosen + 1, measure));
  }
  function choose(i) {
    chosen = i;
    pictures();
    compare();
  }
  function pin(c) {
    if (!pinned.delete(c.file)) pinned.add(c.file);
    compare();
  }
  function accept(i) {
    ask(`drawings/${d.id}/accept`, { round: Number(set.slice(6)), candidate: i + 1 })
      .then((a) => say(`option ${i + 1} is now ${a.drawing}`));
  }
  function compare() {
    const kept = result.candidates.filter(passes(columns));
    const first = kept.toSorted((a, b) => pinned.has(b.file) - pinned.has(a.file)).slice(0, ROWS);
    count.textContent = `${kept.length} of ${result.candidates.length} options` + (kept.length > ROWS ? `, the first ${ROWS} listed` : "");
    const focus = document.activeElement?.id;
    body.replaceChildren(...first.map((c) => {
      const i = result.candidates.indexOf(c);
      return el("tr", { class: pinned.has(c.file) ? "pinned" : "" },
        el("th", { scope: "row" }, String(i + 1)),
        el("td", {}, el("div", { class: "bar" },
          el("button", { id: `show-${i}`, "aria-pressed": String(i === chosen), onclick: () => choose(i) }, `Show ${i + 1}`),
          el("button", { id: `pin-${i}`, "aria-pressed": String(pinned.has(c.file)), onclick: () => pin(c) }, `Pin ${i + 1}`),
          el("button", { id: `accept-${i}`, onclick: () => accept(i) }, `Accept ${i + 1}`),
          el("a", { href: `/api/drawings/${d.id}/${set}/${encodeURIComponent(c.file)}` }, `File ${i + 1}`))),
        ...columns.slice(0, 12).map((k) => el("td", {}, Number.isFinite(k.of(c)) ? k.of(c).toPrecision(4) : "–")));
    }));
    if (focus) $(focus)?.focus();
    drawParallel(lines, columns, kept, result.candidates[chosen]);
    drawScatter(dots, axes, kept, result.candidates[chosen]);
  }
  const pick = (id, label, options, value, change) => [el("label", { for: id }, label),
    el("select", { id, onchange: (e) => change(e.target.value) }, ...options.map((o, i) => el("option", { value: i, selected: i === value }, o)))];
  const names = columns.map((k) => k.name);
  const filter = (k, side, label) => el("label", {}, `${k.name} ${label}`, el("input", {
    type: "number", step: "any", value: k[side], onchange: (e) => {
      k[side] = Number.isFinite(e.target.valueAsNumber) ? e.target.valueAsNumber : k[side === "from" ? "low" : "high"];
      compare();
    } }));
  place.replaceChildren(
    el("div", { class: "card" }, words, el("div", { class: "bar" },
      ...pick("measure", "Heat map of", shown, 0, (v) => { measure = shown[v]; pictures(); })), picture),
    el("h3", {}, "Compare"), count, lines,
    el("div", { class: "bar" }, ...pick("scatter-x", "Across", names, 0, (v) => { axes = [columns[v], axes[1]]; compare(); }),
      ...pick("scatter-y", "Up", names, Math.min(1, names.length - 1), (v) => { axes = [axes[0], columns[v]]; compare(); })), dots,
    el("details", { class: "card" }, el("summary", {}, "Filter"),
      el("div", { class: "axes" }, ...columns.map((k) => el("fieldset", {}, el("legend", {}, k.name), filter(k, "from", "at least"), filter(k, "to", "at most"))))),
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Options" }, el("table", {}, el("thead", {}, el("tr", {},
      ...["Option", "Do", ...names.slice(0, 12)].map((n) => el("th", { scope: "col" }, n)))), body)),
    thresholds(d, result) ?? "", problems(result) ?? "");
  pictures();
  compare();
}
