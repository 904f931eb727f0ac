// The contour error of all cuts over time.

import uPlot from "uplot";
import { color } from "../../../crates/feedwright/assets/report/theme.js";
import type { Cut } from "./messages";
import { error, errorUnit } from "./units";

/** Places of the curve on the time that is shown: about two for each pixel. */
const PLACES = 2400;

export class Curve {
  onPick: (t_s: number) => void = () => {};
  #plot: uPlot | undefined;
  #cuts: Cut[] = [];
  #place: HTMLElement;

  constructor(place: HTMLElement) {
    this.#place = place;
    new ResizeObserver(() => this.#plot?.setSize({ width: place.clientWidth, height: place.clientHeight })).observe(place);
  }

  show(cuts: Cut[]): void {
    this.#cuts = cuts;
    this.#plot?.destroy();
    this.#plot = undefined;
    if (!cuts.length) return;
    const grid = { stroke: color("--grid"), width: 1 }, axis = { stroke: color("--ink-3"), grid, ticks: grid, font: "12px system-ui, sans-serif" };
    const options: uPlot.Options = {
      width: this.#place.clientWidth,
      height: this.#place.clientHeight,
      legend: { show: false },
      scales: { x: { time: false } },
      cursor: { drag: { x: true, y: false, setScale: false }, points: { show: false } },
      axes: [{ ...axis, size: 28, values: (_, ticks) => ticks.map((t, i) => (i === ticks.length - 1 ? `${t} s` : `${t}`)) },
        { ...axis, size: 52, label: errorUnit(), labelSize: 16, labelFont: "12px system-ui, sans-serif" }],
      series: [{}, ...cuts.map((cut) => ({ label: cut.figures.name, stroke: color(`--${cut.look}`), width: 1, points: { show: false } }))],
      hooks: {
        setSelect: [(plot) => {
          const { left, width } = plot.select;
          if (width > 4) this.#range(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
          plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
      },
    };
    this.#plot = new uPlot(options, this.#data(0, this.#end()), this.#place);
    this.#plot.over.addEventListener("click", () => {
      const left = this.#plot!.cursor.left ?? -1;
      if (left >= 0) this.onPick(this.#plot!.posToVal(left, "x"));
    });
    this.#plot.over.addEventListener("dblclick", () => this.#range(0, this.#end()));
  }

  /** The tool is at this time. */
  tool(t_s: number): void {
    const plot = this.#plot;
    plot?.setCursor({ left: plot.valToPos(t_s, "x"), top: plot.over.clientHeight / 2 }, false);
  }

  #end(): number { return Math.max(...this.#cuts.map(({ t_s }) => t_s[t_s.length - 1] ?? 0)); }

  #range(from_s: number, to_s: number): void {
    this.#plot!.setData(this.#data(from_s, to_s), false);
    this.#plot!.batch(() => {
      this.#plot!.setScale("x", { min: from_s, max: to_s });
    });
  }

  /** The largest error about each of the places, with its sign. */
  #data(from_s: number, to_s: number): uPlot.AlignedData {
    const apart_s = (to_s - from_s) / PLACES || 1, times = Array.from({ length: PLACES + 1 }, (_, k) => from_s + k * apart_s);
    const columns = this.#cuts.map(({ t_s, error_um, cutting }) => {
      const values: (number | null)[] = times.map(() => null);
      const put = (k: number, value: number) => {
        if (Math.abs(value) > Math.abs(values[k] ?? 0)) values[k] = value;
      };
      for (let i = 0; i < t_s.length; i++) {
        const k = Math.round((t_s[i] - from_s) / apart_s);
        if (!cutting[i] || k < 0 || k > PLACES) continue;
        const value = error(error_um[i]);
        put(k, value);
        // Between points that are further apart than the places.
        if (!cutting[i + 1]) continue;
        const next = Math.min(PLACES, Math.round((t_s[i + 1] - from_s) / apart_s));
        for (let j = k + 1; j < next; j++) put(j, value + ((error(error_um[i + 1]) - value) * (j - k)) / (next - k));
      }
      return values;
    });
    return [times, ...columns];
  }
}
