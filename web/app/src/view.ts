// The path: programmed in grey, the cut in the color of its contour error, the tool on top.

import { color, errorColor } from "../../../crates/feedwright/assets/report/theme.js";
import type { Checked, Cut } from "./messages";
import { type Strokes, grouped, trace } from "./strokes";

export type Side = "top" | "front" | "right" | "iso";

type Vector = [number, number, number];

// To the right and up on the screen.
const SIDES: Record<Side, [Vector, Vector]> = {
  top: [[1, 0, 0], [0, 1, 0]],
  front: [[1, 0, 0], [0, 0, 1]],
  right: [[0, 1, 0], [0, 0, 1]],
  iso: [[Math.SQRT1_2, Math.SQRT1_2, 0], [-0.408248, 0.408248, 0.816497]],
};

/** Steps of the scale of errors. */
const STEPS = 24;

const MARGIN = 28;

/** While the view moves, a frame that takes longer than the first makes the next one coarser; one below the second makes it finer. */
const [SLOW_MS, FAST_MS] = [50, 20];
/** At the coarsest, one of so many segments is drawn while the view moves. */
const COARSEST = 256;
/** After so long at rest, everything is drawn. */
const REST_MS = 200;

export class PathView {
  /** Factor by which errors are drawn too large; 0 chooses one. */
  gain = 0;
  onPick: (index: number) => void = () => {};
  #path: HTMLCanvasElement;
  #top: HTMLCanvasElement;
  #side: Side = "top";
  /** Center of the screen in mm on the axes of the side, and pixels for each mm. */
  #camera = { x: 0, y: 0, scale: 1 };
  #isFitted = true;
  #programmed: Strokes | undefined;
  #cut: Cut | undefined;
  #drawn: Strokes | undefined;
  #kept: Cut | undefined;
  #keptDrawn: Strokes | undefined;
  #largest_um = 1;
  #live: Float32Array[] = [];
  #tool: Vector | undefined;
  #screen = new Float32Array(0);
  #frame = 0;
  #oneOf = 1;
  #moved_ms = -Infinity;
  #resting = 0;
  #box: [Vector, Vector] | undefined;

  constructor(place: HTMLElement) {
    [this.#path, this.#top] = [0, 1].map(() => place.appendChild(document.createElement("canvas"))) as [HTMLCanvasElement, HTMLCanvasElement];
    this.#top.tabIndex = 0;
    this.#top.setAttribute("role", "img");
    new ResizeObserver(() => this.#resized()).observe(place);
    this.#listen();
  }

  get shownGain(): number { return this.#cut ? this.gain || this.#ownGain() : 1; }
  get largest_um(): number { return this.#largest_um; }

  describe(text: string): void { this.#top.setAttribute("aria-label", text); }

  program({ points, kinds }: Pick<Checked, "points" | "kinds">): void {
    this.#programmed = grouped(points, 2, (end) => kinds[end] & 1);
    this.#box = box(points);
    if (this.#isFitted) this.fit();
    this.redraw();
  }

  /** Shows a cut; errors are colored from 0 to `largest_um`. */
  cut(cut: Cut | undefined, largest_um: number): void {
    this.#cut = cut;
    this.#largest_um = largest_um || 1;
    this.#live = [];
    this.#tool = undefined;
    this.regain();
  }

  /** Draws another cut below the cut, in one color. */
  compare(kept: Cut | undefined): void {
    this.#kept = kept;
    this.regain();
  }

  /** Adds points while they are computed. */
  add(points: Float32Array): void {
    this.#live.push(points);
    const last = points.length - 4;
    if (last >= 0) this.#tool = [points[last], points[last + 1], points[last + 2]];
    this.redraw();
  }

  side(side: Side): void {
    this.#side = side;
    this.fit();
  }

  fit(): void {
    this.#isFitted = true;
    if (!this.#box) return;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => this.#project([0, 1, 2].map((a) => this.#box![(k >> a) & 1][a]) as Vector));
    const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const { clientWidth: w, clientHeight: h } = this.#path, room = (px: number) => Math.max(1, px - 2 * MARGIN);
    const scale = Math.min(room(w) / Math.max(x1 - x0, 1e-6), room(h) / Math.max(y1 - y0, 1e-6));
    this.#camera = { x: (x0 + x1) / 2, y: (y0 + y1) / 2, scale: Math.min(scale, 1e5) };
    this.redraw();
  }

  /** Shows a place large: a tenth of the part around it. */
  zoomTo(position_mm: number[]): void {
    if (!this.#box) return;
    const [from, to] = this.#box, size = Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    const [x, y] = this.#project(position_mm as Vector);
    this.#isFitted = false;
    this.#camera = { x, y, scale: Math.min(this.#path.clientWidth, this.#path.clientHeight) / Math.max(0.1 * size, 1e-3) };
    this.redraw();
  }

  /** The tool stands at a point of the cut. */
  tool(index: number | undefined): void {
    const cut = this.#cut, points = this.#drawn?.points;
    this.#tool = cut && points && index !== undefined ? ([0, 1, 2].map((a) => points[3 * index + a]) as Vector) : undefined;
    this.#drawTool();
  }

  redraw(): void {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.draw();
    });
  }

  /** Draws while the view moves: as much as leaves the motion smooth, and all of it at rest. */
  #move(): void {
    this.#isFitted = false;
    clearTimeout(this.#resting);
    this.#resting = setTimeout(() => {
      this.#moved_ms = -Infinity;
      this.redraw();
    }, REST_MS);
    this.#frame ||= requestAnimationFrame((now_ms) => {
      this.#frame = 0;
      const took_ms = now_ms - this.#moved_ms;
      this.#moved_ms = now_ms;
      // The first frame of a motion tells nothing.
      if (took_ms < REST_MS * 5 && took_ms > SLOW_MS) this.#oneOf = Math.min(COARSEST, 2 * this.#oneOf);
      else if (took_ms < FAST_MS) this.#oneOf = Math.max(1, this.#oneOf / 2);
      this.draw(this.#oneOf);
    });
  }

  /** Draws at once, one of so many segments. */
  draw(oneOf = 1): void {
    const g = this.#path.getContext("2d")!, ratio = devicePixelRatio, { clientWidth: w, clientHeight: h } = this.#path;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, w, h);
    g.lineJoin = "round";
    this.#grid(g, w, h);
    const stroke = (strokes: Strokes, group: number, at: Float32Array) => {
      g.beginPath();
      trace(g, strokes, group, { at, width: w, height: h, oneOf });
      g.stroke();
    };
    if (this.#programmed) {
      const at = this.#projected(this.#programmed.points);
      [g.lineWidth, g.strokeStyle] = [1, color("--rapid")];
      g.setLineDash([3, 4]);
      stroke(this.#programmed, 0, at);
      g.setLineDash([]);
      [g.lineWidth, g.strokeStyle] = [1, color("--path")];
      stroke(this.#programmed, 1, at);
    }
    if (this.#keptDrawn) {
      const at = this.#projected(this.#keptDrawn.points);
      [g.lineWidth, g.strokeStyle] = [1, color("--kept")];
      stroke(this.#keptDrawn, 0, at);
    }
    if (this.#drawn) {
      const at = this.#projected(this.#drawn.points);
      // A wide line costs several times as much as one of a pixel.
      g.lineWidth = this.#drawn.ends.length > 30_000 ? 1 : 1.8;
      for (let step = 0; step < STEPS; step++) {
        g.strokeStyle = errorColor((step + 0.5) / STEPS);
        stroke(this.#drawn, step, at);
      }
    }
    this.#drawLive(g);
    this.#drawTool();
  }

  /** Draws the cut again with another gain. */
  regain(): void {
    const [cut, kept, gain] = [this.#cut, this.#kept, this.shownGain];
    const shade = (i: number) => (cut!.cutting[i] ? Math.min(STEPS - 1, Math.floor((STEPS * Math.abs(cut!.error_um[i])) / this.#largest_um)) : -1);
    this.#drawn = cut && grouped(enlarged(cut, gain), STEPS, shade);
    this.#keptDrawn = cut && kept && grouped(enlarged(kept, gain), 1, (i) => (kept.cutting[i] ? 0 : -1));
    this.redraw();
  }

  /** So that the largest error is a fiftieth of the part, and a round number. */
  #ownGain(): number {
    if (!this.#box) return 1;
    const [from, to] = this.#box, size = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const gain = (0.02 * size) / (1e-3 * this.#largest_um), unit = 10 ** Math.floor(Math.log10(gain));
    return Math.max(1, unit * ([5, 2, 1].find((k) => k * unit <= gain) ?? 1));
  }

  #drawLive(g: CanvasRenderingContext2D): void {
    if (!this.#live.length) return;
    g.lineWidth = 1.8;
    g.strokeStyle = color("--run-1");
    g.beginPath();
    let down = false;
    for (const points of this.#live)
      for (let i = 0; i < points.length; i += 4) {
        const [x, y] = this.#pixel([points[i], points[i + 1], points[i + 2]]);
        if (Number.isNaN(points[i + 3])) down = false;
        else if (down) g.lineTo(x, y);
        else {
          g.moveTo(x, y);
          down = true;
        }
      }
    g.stroke();
  }

  #drawTool(): void {
    const g = this.#top.getContext("2d")!, ratio = devicePixelRatio;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, this.#top.clientWidth, this.#top.clientHeight);
    if (!this.#tool) return;
    const [x, y] = this.#pixel(this.#tool);
    g.fillStyle = color("--panel");
    g.strokeStyle = color("--ink");
    g.lineWidth = 2;
    g.beginPath();
    g.arc(x, y, 5, 0, 2 * Math.PI);
    g.fill();
    g.stroke();
  }

  /** Lines at round distances, and how far apart they are. */
  #grid(g: CanvasRenderingContext2D, w: number, h: number): void {
    const { x, y, scale } = this.#camera, least = 64 / scale, unit = 10 ** Math.floor(Math.log10(least));
    const apart = unit * ([2, 5, 10].find((k) => k * unit >= least) ?? 10);
    g.strokeStyle = color("--grid");
    g.lineWidth = 1;
    g.beginPath();
    for (let k = Math.ceil((x - w / 2 / scale) / apart); k * apart < x + w / 2 / scale; k++) {
      const px = Math.round(w / 2 + (k * apart - x) * scale) + 0.5;
      g.moveTo(px, 0);
      g.lineTo(px, h);
    }
    for (let k = Math.ceil((y - h / 2 / scale) / apart); k * apart < y + h / 2 / scale; k++) {
      const py = Math.round(h / 2 - (k * apart - y) * scale) + 0.5;
      g.moveTo(0, py);
      g.lineTo(w, py);
    }
    g.stroke();
    this.onGrid(apart, this.#side);
  }

  onGrid: (apart_mm: number, side: Side) => void = () => {};

  #project([x, y, z]: Vector): [number, number] {
    const [right, up] = SIDES[this.#side];
    return [right[0] * x + right[1] * y + right[2] * z, up[0] * x + up[1] * y + up[2] * z];
  }

  #pixel(point: Vector): [number, number] {
    const [x, y] = this.#project(point), { x: cx, y: cy, scale } = this.#camera;
    return [this.#path.clientWidth / 2 + (x - cx) * scale, this.#path.clientHeight / 2 - (y - cy) * scale];
  }

  /** x and y of all points in pixels. */
  #projected(points: Float32Array): Float32Array {
    const count = points.length / 3, [r, u] = SIDES[this.#side], { x: cx, y: cy, scale } = this.#camera;
    if (this.#screen.length < 2 * count) this.#screen = new Float32Array(2 * count);
    const at = this.#screen, [left, top] = [this.#path.clientWidth / 2 - cx * scale, this.#path.clientHeight / 2 + cy * scale];
    for (let i = 0; i < count; i++) {
      const x = points[3 * i], y = points[3 * i + 1], z = points[3 * i + 2];
      at[2 * i] = left + scale * (r[0] * x + r[1] * y + r[2] * z);
      at[2 * i + 1] = top - scale * (u[0] * x + u[1] * y + u[2] * z);
    }
    return at;
  }

  #resized(): void {
    for (const canvas of [this.#path, this.#top]) {
      canvas.width = Math.round(canvas.clientWidth * devicePixelRatio);
      canvas.height = Math.round(canvas.clientHeight * devicePixelRatio);
    }
    if (this.#isFitted) this.fit();
    this.draw();
  }

  pan(dx: number, dy: number): void {
    this.#camera.x -= dx / this.#camera.scale;
    this.#camera.y += dy / this.#camera.scale;
    this.#move();
  }

  /** Zooms about a pixel. */
  zoom(factor: number, px = this.#path.clientWidth / 2, py = this.#path.clientHeight / 2): void {
    const camera = this.#camera, [dx, dy] = [px - this.#path.clientWidth / 2, this.#path.clientHeight / 2 - py];
    const scale = Math.min(1e6, Math.max(1e-4, camera.scale * factor));
    camera.x += dx / camera.scale - dx / scale;
    camera.y += dy / camera.scale - dy / scale;
    camera.scale = scale;
    this.#move();
  }

  /** The point of the cut nearest to a pixel; none beyond a finger's width. */
  #nearest(px: number, py: number): number | undefined {
    if (!this.#drawn) return undefined;
    const at = this.#projected(this.#drawn.points);
    let [found, least]: [number | undefined, number] = [undefined, 24 ** 2];
    for (let i = 0; i < this.#drawn.count; i++) {
      const distance = (at[2 * i] - px) ** 2 + (at[2 * i + 1] - py) ** 2;
      if (distance < least) [found, least] = [i, distance];
    }
    return found;
  }

  #listen(): void {
    const canvas = this.#top, fingers = new Map<number, { x: number; y: number }>();
    let moved = 0;
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 16 : 1)), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
      if (fingers.size === 1) moved = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const now = { x: event.offsetX, y: event.offsetY };
      const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const spread = (p: { x: number; y: number }) => Math.hypot(p.x - other.x, p.y - other.y);
        this.zoom(spread(now) / Math.max(1, spread(before)), (now.x + other.x) / 2, (now.y + other.y) / 2);
      }
      const share = other ? 0.5 : 1;
      this.pan(share * (now.x - before.x), share * (now.y - before.y));
      moved += Math.abs(now.x - before.x) + Math.abs(now.y - before.y);
      fingers.set(event.pointerId, now);
    });
    const up = (event: PointerEvent) => {
      if (fingers.delete(event.pointerId) && event.type === "pointerup" && moved < 4) {
        const index = this.#nearest(event.offsetX, event.offsetY);
        if (index !== undefined) this.onPick(index);
      }
    };
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    canvas.addEventListener("dblclick", () => this.fit());
    const keys: Record<string, () => void> = {
      ArrowLeft: () => this.pan(40, 0), ArrowRight: () => this.pan(-40, 0), ArrowUp: () => this.pan(0, 40), ArrowDown: () => this.pan(0, -40),
      "+": () => this.zoom(1.25), "=": () => this.zoom(1.25), "-": () => this.zoom(0.8), "0": () => this.fit(),
    };
    canvas.addEventListener("keydown", (event) => {
      const act = !event.ctrlKey && !event.metaKey && keys[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    });
  }
}

/** The path of a cut with its errors drawn larger. */
const enlarged = ({ foot_mm, deviation_mm }: Cut, gain: number) => foot_mm.map((mm, k) => mm + gain * deviation_mm[k]);

/** Corners of the box around all points. */
function box(points: Float32Array): [Vector, Vector] | undefined {
  if (!points.length) return undefined;
  const [from, to]: [Vector, Vector] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let i = 0; i < points.length; i++) {
    from[i % 3] = Math.min(from[i % 3], points[i]);
    to[i % 3] = Math.max(to[i % 3], points[i]);
  }
  return [from, to];
}
