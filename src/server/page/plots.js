// Parallel coordinates and a scatter of many options: drawn in slices, so that thousands never hold up the page.

/** Options drawn in one frame, and of those so many by one stroke: a stroke costs more than its lines. */
const SLICE = 120;
const STROKE = 12;
const [TOP, BOTTOM, SIDE] = [34, 30, 46];
/** Names of axes nearer to each other than this, in pixels, are written upwards, and need this room above. */
const [UPRIGHT_BELOW, UPRIGHT_ROOM] = [84, 112];
/** A line of text needs this much; where axes are nearer, every other or third one is named. */
const LINE = 14;
const ink = () => getComputedStyle(document.body).color;
/** Nearer to an option than this, in pixels, a click means it. */
const NEAR = 24;

export function part(k, c) { return (k.of(c) - k.low) / (k.high - k.low || 1); }

function pen(view) {
  const ratio = devicePixelRatio || 1;
  view.width = view.clientWidth * ratio;
  view.height = view.clientHeight * ratio;
  const out = view.getContext("2d");
  out.scale(ratio, ratio);
  out.strokeStyle = out.fillStyle = getComputedStyle(view).color;
  out.font = "12px system-ui";
  out.lineJoin = "round";
  return out;
}

/** Draws the rest of a list from frame to frame, until it is through or something newer is drawn on the same view. */
const turns = new WeakMap();
function inSlices(view, list, draw, last) {
  const turn = (turns.get(view) ?? 0) + 1;
  turns.set(view, turn);
  const go = (from) => {
    if (turns.get(view) !== turn) return;
    for (let i = from; i < Math.min(from + SLICE, list.length); i += STROKE) draw(list.slice(i, Math.min(i + STROKE, from + SLICE)));
    if (from + SLICE < list.length) requestAnimationFrame(() => go(from + SLICE));
    else last();
  };
  go(0);
}

/** Some of many, evenly spread: what is drawn while a range is. */
function some(list) {
  const step = Math.max(1, list.length / SLICE);
  return Array.from({ length: Math.min(SLICE, list.length) }, (_, i) => list[Math.floor(i * step)]);
}

const short = (v) => Number(v.toPrecision(3)).toString();

export class Parallel {
  /** `changed` is called while a range is drawn with the pointer, `settled` when it stands. */
  constructor(view, columns, changed, settled) {
    Object.assign(this, { view, columns });
    const at = (e) => {
      const box = view.getBoundingClientRect();
      return [e.clientX - box.left, e.clientY - box.top];
    };
    let [axis, start] = [null, 0];
    view.addEventListener("pointerdown", (e) => {
      const [x, y] = at(e);
      axis = columns.reduce((a, _, i) => Math.abs(this.x(i) - x) < Math.abs(this.x(a) - x) ? i : a, 0);
      start = y;
      view.setPointerCapture(e.pointerId);
    });
    view.addEventListener("pointermove", (e) => {
      if (axis === null) return;
      const k = columns[axis];
      const [a, b] = [this.value(k, start), this.value(k, at(e)[1])];
      [k.from, k.to] = [Math.min(a, b), Math.max(a, b)];
      changed();
    });
    const end = (e) => {
      if (axis === null) return;
      // A click takes the range off.
      if (Math.abs(at(e)[1] - start) < 4) [columns[axis].from, columns[axis].to] = [columns[axis].low, columns[axis].high];
      axis = null;
      settled();
    };
    view.addEventListener("pointerup", end);
    view.addEventListener("pointercancel", end);
  }

  get gap() { return (this.view.clientWidth - 2 * SIDE) / Math.max(1, this.columns.length - 1); }
  get top() { return this.gap < UPRIGHT_BELOW ? UPRIGHT_ROOM : TOP; }
  x(i) { return SIDE + this.gap * i; }
  y(k, v) { return this.view.clientHeight - BOTTOM - (this.view.clientHeight - this.top - BOTTOM) * (v - k.low) / (k.high - k.low || 1); }
  value(k, y) {
    const t = (this.view.clientHeight - BOTTOM - y) / (this.view.clientHeight - this.top - BOTTOM);
    return k.low + (k.high - k.low) * Math.min(1, Math.max(0, t));
  }

  drawAxes(p) {
    const { view, columns, gap, top } = this;
    p.strokeStyle = p.fillStyle = ink();
    p.lineWidth = 1;
    columns.forEach((k, i) => {
      const x = this.x(i);
      p.textAlign = i === 0 ? "left" : i === columns.length - 1 ? "right" : "center";
      const left = i === 0 ? 4 : i === columns.length - 1 ? view.clientWidth - 4 : x;
      p.globalAlpha = 0.6;
      p.strokeRect(x, top, 0, view.clientHeight - top - BOTTOM);
      if (k.from > k.low || k.to < k.high) {
        p.globalAlpha = 0.25;
        p.fillRect(x - 7, this.y(k, k.to), 14, Math.max(2, this.y(k, k.from) - this.y(k, k.to)));
      }
      p.globalAlpha = 1;
      if (gap < UPRIGHT_BELOW) {
        p.save();
        p.translate(x, top - 6);
        p.rotate(-Math.PI / 2);
        p.textAlign = "left";
        p.textBaseline = "middle";
        if (i % Math.ceil(LINE / gap) === 0) p.fillText(shortened(p, k.name, UPRIGHT_ROOM - 10), 0, 0);
        p.restore();
      } else {
        p.fillText(shortened(p, k.name, gap - 6), left, 13);
        p.fillText(short(k.high), left, 28);
      }
      if (gap >= UPRIGHT_BELOW) p.fillText(short(k.low), left, view.clientHeight - 10);
    });
  }

  /** `isQuick`: some of the options stand for all. */
  draw(kept, isMarked, isQuick) {
    const { view, columns } = this;
    const p = pen(view);
    const xs = columns.map((_, i) => this.x(i));
    const lines = (list) => {
      p.beginPath();
      for (const c of list) columns.forEach((k, i) => p[i ? "lineTo" : "moveTo"](xs[i], this.y(k, k.of(c))));
      p.stroke();
    };
    const others = kept.filter((c) => !isMarked(c));
    const drawn = isQuick ? some(others) : others;
    this.drawAxes(p);
    p.strokeStyle = getComputedStyle(view).color;
    p.lineWidth = 1;
    p.globalAlpha = Math.max(0.03, Math.min(0.6, 60 / drawn.length));
    inSlices(view, drawn, lines, () => {
      p.globalAlpha = 1;
      p.lineWidth = 3;
      lines(kept.filter(isMarked));
    });
  }
}

/** A name in the room that there is. */
function shortened(p, text, room) {
  if (p.measureText(text).width <= room) return text;
  let n = text.length;
  while (n > 1 && p.measureText(text.slice(0, n) + "…").width > room) n -= 1;
  return text.slice(0, n) + "…";
}

/** Calls when views have another size or other colours, as long as they are shown. */
export function onNewLook(views, draw) {
  new ResizeObserver(draw).observe(views[0]);
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  const changed = () => { if (views[0].isConnected) draw(); else scheme.removeEventListener("change", changed); };
  scheme.addEventListener("change", changed);
}

export class Scatter {
  constructor(view, choose) {
    this.view = view;
    this.kept = [];
    view.addEventListener("click", (e) => {
      const box = view.getBoundingClientRect();
      const far = (c) => Math.hypot(...this.at(c).map((v, i) => v - [e.clientX - box.left, e.clientY - box.top][i]));
      let [best, least] = [null, NEAR];
      for (const c of this.kept) {
        const d = far(c);
        if (d < least) [best, least] = [c, d];
      }
      if (best) choose(best);
    });
  }

  at(c) {
    const [w, h] = [this.view.clientWidth, this.view.clientHeight];
    return [SIDE + (w - 2 * SIDE) * part(this.axes[0], c), h - BOTTOM - 6 - (h - TOP - BOTTOM - 12) * part(this.axes[1], c)];
  }

  draw(axes, kept, isMarked, isQuick) {
    Object.assign(this, { axes, kept });
    const { view } = this;
    const p = pen(view);
    const dots = (radius) => (list) => {
      p.beginPath();
      for (const c of list) {
        const [x, y] = this.at(c);
        p.moveTo(x + radius, y);
        p.arc(x, y, radius, 0, 7);
      }
      p.fill();
    };
    p.fillStyle = ink();
    const [a, b] = axes;
    p.fillText(`${b.name} ↑ ${short(b.low)} … ${short(b.high)}`, 6, 14);
    p.textAlign = "right";
    p.fillText(`${a.name} → ${short(a.low)} … ${short(a.high)}`, view.clientWidth - 6, view.clientHeight - 8);
    p.fillStyle = getComputedStyle(view).color;
    const others = kept.filter((c) => !isMarked(c));
    p.globalAlpha = kept.length > 500 ? 0.25 : 0.55;
    inSlices(view, isQuick ? some(others) : others, dots(kept.length > 500 ? 2.5 : 4), () => {
      p.globalAlpha = 1;
      dots(7)(kept.filter(isMarked));
    });
  }
}
