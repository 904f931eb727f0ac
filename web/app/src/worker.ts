// Answers requests with the library, which is WebAssembly. A worker has one thread: it is ended to cancel its work.

import type { Answers, Checked, Corrected, Cut, FromWorker, Identified, RunAnswer, ToWorker } from "./messages";

interface Exports {
  memory: WebAssembly.Memory;
  input(bytes: number): number;
  program(bytes: number): number;
  run(): number;
  at(output: number): number;
  length(output: number): number;
}

const post = (message: FromWorker, transfer: Transferable[] = []) => self.postMessage(message, { transfer });

self.onmessage = async ({ data: { id, module, request } }: MessageEvent<ToWorker>) => {
  try {
    // The memory of an instance only grows: each request has its own.
    let exports: Exports;
    const bytes = (at: number, length: number) => new Uint8Array(exports.memory.buffer, at, length);
    const text = (at: number, length: number) => new TextDecoder().decode(bytes(at, length));
    const page = {
      progress: (at: number, length: number, thousandths: number) =>
        post({ id, kind: "progress", stage: text(at, length), part: thousandths / 1000 }),
      cut: (at: number, count: number) => {
        const points = new Float32Array(exports.memory.buffer, at, 4 * count).slice();
        post({ id, kind: "points", points }, [points.buffer]);
      },
    };
    exports = (await WebAssembly.instantiate(module, { page })).exports as unknown as Exports;
    const { program = "", ...asked } = request;
    // Room may make the memory grow.
    const put = (text: string, room: (bytes: number) => number) => {
      const written = new TextEncoder().encode(text), at = room(written.length);
      bytes(at, written.length).set(written);
    };
    put(program, exports.program);
    put(JSON.stringify(asked), exports.input);
    const succeeded = exports.run() === 1;
    const output = (k: number) => bytes(exports.at(k), exports.length(k));
    const outputText = (k: number) => new TextDecoder().decode(output(k));
    if (!succeeded) {
      post({ id, kind: "failed", reason: outputText(0) });
      return;
    }
    const [answer, transfer] = await answers[request.task](outputText, output);
    post({ id, kind: "done", answer }, transfer);
  } catch (error) {
    post({ id, kind: "failed", reason: `the engine stopped: ${error}` });
  }
};

type Read<T> = (text: (k: number) => string, bytes: (k: number) => Uint8Array) => [T, Transferable[]] | Promise<[T, Transferable[]]>;

const answers: { [task in keyof Answers]: Read<Answers[task]> } = { lists, check, correct, identify, run };

function lists(text: (k: number) => string): [Answers["lists"], Transferable[]] {
  return [JSON.parse(text(0)), []];
}

function check(text: (k: number) => string, bytes: (k: number) => Uint8Array): [Checked, Transferable[]] {
  const { findings, amounts_to, is_whole, machine } = JSON.parse(text(0));
  const points = new Float32Array(bytes(1).slice().buffer), kinds = new Uint32Array(bytes(2).slice().buffer);
  return [{ findings, amounts: amounts_to, isWhole: is_whole, machine, points, kinds }, [points.buffer, kinds.buffer]];
}

function correct(text: (k: number) => string): [Corrected, Transferable[]] {
  return [{ ...JSON.parse(text(0)), program: text(1) }, []];
}

function identify(text: (k: number) => string): [Identified, Transferable[]] {
  return [{ ...JSON.parse(text(0)), file: text(1), page: new Blob([text(2)], { type: "text/html" }) }, []];
}

async function run(text: (k: number) => string): Promise<[RunAnswer, Transferable[]]> {
  const results = JSON.parse(text(0)), table = JSON.parse(text(3)), page = text(2);
  // The report holds everything that is drawn: the page reads what it reads.
  const data = await inflated(between(page, '<script type="text/plain" id="data">', "</script>"));
  const cuts = data.runs.map((columns: Columns, k: number) =>
    cut(columns, data.meta, k, { figures: table.runs[k], worst: results.runs[k].worst }));
  const verdict = between(page, '<p class="verdict">', "</p>").replace(/<[^>]*>/g, "").replace(/&amp;/g, "&");
  const transfer = cuts.flatMap((cut: Cut) =>
    [cut.t_s, cut.error_um, cut.line, cut.cutting, cut.foot_mm, cut.deviation_mm].map((column) => column.buffer));
  const report = new Blob([page], { type: "text/html" });
  return [{ cuts, remarks: table.remarks, verdict, report }, transfer];
}

/** The data of a report are deflated JSON in base64. */
async function inflated(base64: string) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).json();
}

type Columns = { [name: string]: number[] };
interface Meta { units: { time_s: number; point_mm: number }; runs: { error_mm: number }[] }

/** A run of the report: its columns are differences of integers, see crates/feedwright/src/report/embedded_data.rs. */
function cut(columns: Columns, { units, runs }: Meta, k: number, rest: Pick<Cut, "figures" | "worst">): Cut {
  const n = columns.t.length, error_mm = runs[k].error_mm;
  const decoded = <T extends Float32Array | Uint32Array | Uint8Array>(into: T, name: string, unit: number, first = 0, step = 1) => {
    let sum = 0;
    columns[name]?.forEach((difference, i) => { sum += difference; into[first + step * i] = sum * unit; });
    return into;
  };
  const [foot_mm, deviation_mm] = [new Float32Array(3 * n), new Float32Array(3 * n)];
  ["x", "y", "z"].forEach((axis, a) => {
    decoded(foot_mm, `f${axis}`, units.point_mm, a, 3);
    decoded(deviation_mm, `d${axis}`, error_mm, a, 3);
  });
  return {
    ...rest, foot_mm, deviation_mm, look: `run-${k}`,
    t_s: decoded(new Float32Array(n), "t", units.time_s),
    error_um: decoded(new Float32Array(n), "e", 1e3 * error_mm),
    line: decoded(new Uint32Array(n), "line", 1),
    cutting: decoded(new Uint8Array(n), "cutting", 1),
  };
}

function between(text: string, before: string, after: string): string {
  const from = text.indexOf(before);
  if (from < 0) return "";
  return text.slice(from + before.length, text.indexOf(after, from + before.length));
}
