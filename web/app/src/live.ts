// The machine itself, as `feedwright open --hal` reads it from LinuxCNC.

import { $ } from "./dom";
import type { Cut, Figures } from "./messages";
import { fillTable } from "./rows";
import { errorText, errorUnit } from "./units";

/** States of the component, by number. */
const STATES = ["Amplifiers are off", "Not delayed, not corrected", "Delayed, not corrected", "The correction fades out", "Correcting"];
/** From this state on there is a contour error. */
const DELAYED = 2;
const ASK_MS = 200;
/** The curve shows the last minute, s. */
const SHOWN_S = 60;
/** Points of the path: five minutes. */
const MOST = 7500;

/** A reading of the pins, see crates/feedwright/src/command/hal_watch.rs: time, position, errors with and without the correction, state. */
type Row = [t_s: number, x: number, y: number, z: number, with_um: number, without_um: number, state: number];
interface Now { state: number; enable: boolean; cause: string | null; fault: boolean; correction_um: number[]; limit_um: number }
interface Answer { next: number; rows: Row[]; now: Now | null; trouble: string | null }

export class Live {
  /** Called with the path, and with the errors of the last minute. */
  onRows: (path: Cut, errors: Cut[]) => void = () => {};
  #rows: Row[] = [];

  async start(): Promise<void> {
    $("live").hidden = false;
    $("live-clear").addEventListener("click", () => (this.#rows = []));
    for (let next = 0; ; await new Promise((later) => setTimeout(later, ASK_MS))) {
      const answer: Answer | undefined = await fetch(`hal/${next}`).then((answer) => answer.json()).catch(() => undefined);
      if (!answer) {
        this.#tell("'feedwright open' has ended. Start it again.", undefined);
        continue;
      }
      next = answer.next;
      this.#rows = [...this.#rows, ...answer.rows].slice(-MOST);
      this.#tell(answer.trouble ?? "", answer.now ?? undefined);
      this.show();
    }
  }

  show(): void {
    if (!this.#rows.length) return;
    const end_s = this.#rows[this.#rows.length - 1][0], last = this.#rows.filter(([t_s]) => t_s > end_s - SHOWN_S);
    const [without, measured] = [cut(last, "without correction", 5, "run-0"), cut(last, "measured", 4, "run-1")];
    fillTable($("live-figures"), [without, measured].map(({ figures: { name, max_um }, look, error_um }) =>
      ({ name, look, numbers: [errorText(error_um[error_um.length - 1]), errorText(max_um)] })));
    this.onRows(cut(this.#rows, "measured", 4, "run-1"), [without, measured]);
  }

  #tell(trouble: string, now: Now | undefined): void {
    const state = !now ? trouble : `${STATES[now.state] ?? `State ${now.state}`}${now.enable ? "" : ". The correction is switched off"}`;
    put("live-state", state);
    put("live-cause", now?.cause ? `${now.fault ? "Fault" : "Last fault"}: ${now.cause}` : "");
    $("live-cause").classList.toggle("alarm", !!now?.fault);
    const axes = now?.correction_um.map((um, axis) => `${"XYZ"[axis]} ${errorText(um).replace("-", "−")}`).join("  ");
    put("live-correction", now ? `Correction ${axes} of ${errorText(now.limit_um)} ${errorUnit()}` : "");
  }
}

/** A screen reader reads what changes: the same text is no change. */
function put(id: string, text: string): void {
  if ($(id).textContent !== text) $(id).textContent = text;
}

/** Readings as a cut; the error is in one of their columns. */
function cut(rows: Row[], name: string, column: number, look: string): Cut {
  const begin_s = rows[0][0], error_um = new Float32Array(rows.map((row) => row[column]));
  const cutting = new Uint8Array(rows.map((row) => Number(row[6] >= DELAYED)));
  const max_um = Math.max(...error_um.map((um, i) => (cutting[i] ? um : 0))).toFixed(2), figures: Figures = { name, time_s: "", rms_um: "", max_um };
  return {
    figures, look, error_um, cutting, worst: [], limits: [],
    t_s: new Float32Array(rows.map(([t_s]) => t_s - begin_s)),
    line: new Uint32Array(rows.length),
    foot_mm: new Float32Array(rows.flatMap(([, x, y, z]) => [x, y, z])),
    deviation_mm: new Float32Array(3 * rows.length),
  };
}
