// What the page and its workers say to each other.

/** A request for the engine, as web/engine/src/request.rs has it. */
export interface EngineRequest {
  task: "run" | "check" | "correct" | "identify" | "lists";
  name?: string;
  /** A text, or a file, which the worker reads: a long program is not copied from one to the other. */
  program?: string | Blob;
  machine?: string;
  machine_name?: string;
  controller?: string;
  target?: string;
  recorded_on?: string;
  page?: boolean;
}

export interface Named { name: string; about: string; axes?: number }

export interface Lists {
  version: string;
  machines: Named[]; machine: string;
  controllers: Named[]; controller: string;
  controls: Named[]; control: string;
}

export interface Finding {
  severity: "error" | "warning";
  line: number; column: number; length: number;
  message: string; hint: string | null;
}

export interface Checked {
  findings: Finding[];
  amounts: { lines: number; motions: number; feed_mm: number; rapid_mm: number; dialect: string } | null;
  isWhole: boolean;
  machine?: { name: string; about: string };
  /** x, y, z of each point, mm. */
  points: Float32Array;
  /** Twice the line; odd where the tool cuts on its way to the point. */
  kinds: Uint32Array;
}

/** A row of a table, with the digits of the command. */
export interface Figures { name: string; time_s: string; rms_um: string; max_um: string; uncut_um?: string; blocks?: number; record?: Recorded[] }

/** The controller leaves the loop, or returns, or learns. */
export interface Recorded { t_s: number; line: number; text: string }

export interface Place { error_um: number; line: number; text: string; position_mm: number[]; t_s: number }

/** A cut. All columns have a value for each of its points. */
export interface Cut {
  figures: Figures;
  /** The color of its curve: "run-0", "run-1", or "kept" for one that later cuts are compared with. */
  look: string;
  worst: Place[];
  /** Limits that bind its plan: name, part of the time in percent, line where it binds longest. */
  limits: [string, number, number][];
  t_s: Float32Array;
  error_um: Float32Array;
  line: Uint32Array;
  cutting: Uint8Array;
  /** x, y, z of the nearest point of the programmed path, mm. */
  foot_mm: Float32Array;
  /** From there to the tool, mm. */
  deviation_mm: Float32Array;
}

export interface RunAnswer { cuts: Cut[]; remarks: string[]; verdict: string; report: Blob }

export interface Corrected {
  figures: Figures[];
  control: string;
  refusal: string | null; hint: string | null;
  stretches: number; stretches_changed: number; rounds: number;
  program: string;
}

/** `numbers` has name, value, unit, interval and source of each. */
export interface IdentifiedAxis { name: string; verdict: string; numbers: [string, string, string, string, string][] }

export interface Identified {
  axes: IdentifiedAxis[];
  findings: string[]; improvements: string[]; advice: string[];
  file: string;
  page: Blob;
}

export interface Answers { run: RunAnswer; check: Checked; correct: Corrected; identify: Identified; lists: Lists }

export type FromWorker =
  | { id: number; kind: "progress"; stage: string; part: number }
  | { id: number; kind: "points"; points: Float32Array }
  | { id: number; kind: "done"; answer: Answers[keyof Answers] }
  | { id: number; kind: "failed"; reason: string };

/** `engine` tells builds of the engine apart; empty where it is not known. */
export interface ToWorker { id: number; module: WebAssembly.Module; engine: string; request: EngineRequest }
