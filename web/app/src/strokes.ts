// Segments of a polyline, grouped by a shade so that a canvas strokes each group at once.

/** A polyline of points in space whose segment i ends at point i. */
export interface Strokes {
  count: number;
  points: Float32Array;
  /** Ends of segments, group by group, in their order within a group. */
  ends: Uint32Array;
  /** Where each group begins in `ends`, and the end of the last. */
  starts: Uint32Array;
}

/** Groups the segments; `shade` is negative for what is not drawn. */
export function grouped(points: Float32Array, groups: number, shade: (end: number) => number): Strokes {
  const count = points.length / 3, shades = new Int16Array(count).fill(-1), starts = new Uint32Array(groups + 1);
  for (let i = 1; i < count; i++) {
    shades[i] = shade(i);
    if (shades[i] >= 0) starts[shades[i] + 1]++;
  }
  for (let g = 0; g < groups; g++) starts[g + 1] += starts[g];
  const ends = new Uint32Array(starts[groups]), next = starts.slice();
  for (let i = 1; i < count; i++) if (shades[i] >= 0) ends[next[shades[i]]++] = i;
  return { count, points, ends, starts };
}

/** Shorter pieces of a line than this are drawn with the next one, pixels. */
const SHORTEST = 0.7;

/** Segments that are drawn or left out together. */
const RUN = 32;

/** Where a polyline is drawn: x and y of each point and the size of the canvas, in pixels, and one of how many segments. */
export interface Sheet { at: Float32Array; width: number; height: number; oneOf: number }

/** Adds a group to the current path of a canvas. Nothing outside of the canvas is drawn. */
export function trace(g: CanvasRenderingContext2D, { ends, starts }: Strokes, group: number, { at, width, height, oneOf }: Sheet): void {
  let pen = -1, penX = 0, penY = 0;
  for (let k = starts[group]; k < starts[group + 1]; k++) {
    const end = ends[k];
    if (oneOf > 1 && Math.floor(end / RUN) % oneOf) continue;
    const x = at[2 * end], y = at[2 * end + 1], x0 = at[2 * end - 2], y0 = at[2 * end - 1];
    if ((x < 0 && x0 < 0) || (y < 0 && y0 < 0) || (x > width && x0 > width) || (y > height && y0 > height)) continue;
    const isNext = pen === end - 1;
    if (!isNext) {
      g.moveTo(x0, y0);
      penX = x0;
      penY = y0;
    }
    pen = end;
    const follows = k + 1 < starts[group + 1] && ends[k + 1] === end + 1;
    if (follows && Math.abs(x - penX) + Math.abs(y - penY) < SHORTEST) continue;
    g.lineTo(x, y);
    penX = x;
    penY = y;
  }
}
