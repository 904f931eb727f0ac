// Answers requests with the library, which is WebAssembly. A worker has one thread: it is ended to cancel its work.

import { decode } from "../../../crates/feedwright/assets/report/data.js";
import type { Answers, Checked, Corrected, Cut, FromWorker, Identified, RunAnswer, ToWorker } from "./messages";

interface Exports {
  memory: WebAssembly.Memory;
  input(bytes: number): number;
  program(bytes: number): number;
  run(): number;
  at(output: number): number;
  length(output: number): number;
}

/** Models that logs told, by the names that the engine gives them: for later requests, and for later visits where there is room. */
interface Models { texts: Map<string, string>; store?: Cache }

/** Beginning of the name of a store; the hash of the engine is behind it. */
const MODELS = "feedwright models ";
let models: Promise<Models> | undefined;

async function keptModels(engine: string): Promise<Models> {
  const kept: Models = { texts: new Map() };
  try {
    const name = MODELS + engine;
    if (engine) kept.store = await caches.open(name);
    // Another engine may come to other models.
    for (const other of await caches.keys()) if (other.startsWith(MODELS) && other !== name) await caches.delete(other);
    for (const key of await kept.store?.keys() ?? []) {
      kept.texts.set(key.url.split("/").pop()!, await (await kept.store!.match(key))!.text());
    }
  } catch {
    // A browser that keeps nothing.
  }
  return kept;
}

/** About 0.2 MB each. */
const MOST_MODELS = 50;

function keep({ texts, store }: Models, name: string, text: string): void {
  texts.set(name, text);
  const given_up = texts.size > MOST_MODELS ? [...texts.keys()][0] : undefined;
  if (given_up) texts.delete(given_up);
  const written = store?.put(`kept/${name}`, new Response(text)).then(() => given_up ? store.delete(`kept/${given_up}`) : true);
  // Where there is no room they are kept as long as the worker lives.
  written?.catch(() => undefined);
}

const post = (message: FromWorker, transfer: Transferable[] = []) => self.postMessage(message, { transfer });

self.onmessage = async ({ data: { id, module, engine, request } }: MessageEvent<ToWorker>) => {
  try {
    // The memory of an instance only grows: each request has its own.
    let exports: Exports, found = new Uint8Array();
    const kept = await (models ??= keptModels(engine));
    const bytes = (at: number, length: number) => new Uint8Array(exports.memory.buffer, at, length);
    const text = (at: number, length: number) => new TextDecoder().decode(bytes(at, length));
    const page = {
      progress: (at: number, length: number, thousandths: number) =>
        post({ id, kind: "progress", stage: text(at, length), part: thousandths / 1000 }),
      cut: (at: number, count: number) => {
        const points = new Float32Array(exports.memory.buffer, at, 4 * count).slice();
        post({ id, kind: "points", points }, [points.buffer]);
      },
      find: (at: number, length: number) => {
        const of = kept.texts.get(text(at, length));
        found = new TextEncoder().encode(of);
        return of === undefined ? -1 : found.length;
      },
      take: (at: number) => bytes(at, found.length).set(found),
      keep: (name: number, nameLength: number, at: number, length: number) => keep(kept, text(name, nameLength), text(at, length)),
    };
    exports = (await WebAssembly.instantiate(module, { page })).exports as unknown as Exports;
    const { program = "", ...asked } = request;
    // Room may make the memory grow.
    const put = async (content: Blob, room: (bytes: number) => number) => {
      let at = room(content.size);
      for (const reader = content.stream().getReader(); ; ) {
        const { done, value } = await reader.read();
        if (done) return;
        bytes(at, value.length).set(value);
        at += value.length;
      }
    };
    const isRead = await put(new Blob([program]), exports.program).then(() => true, () => false);
    if (!isRead) return post({ id, kind: "failed", reason: `${asked.name} was changed or moved since it was opened. Open it again` });
    await put(new Blob([JSON.stringify(asked)]), exports.input);
    const succeeded = exports.run() === 1;
    const output = (k: number) => bytes(exports.at(k), exports.length(k));
    const outputText = (k: number) => new TextDecoder().decode(output(k));
    if (!succeeded) {
      post({ id, kind: "failed", reason: outputText(0) });
      return;
    }
    const [answer, transfer] = answers[request.task](outputText, output);
    post({ id, kind: "done", answer }, transfer);
  } catch (error) {
    post({ id, kind: "failed", reason: `the engine stopped: ${error}` });
  }
};

type Read<T> = (text: (k: number) => string, bytes: (k: number) => Uint8Array<ArrayBuffer>) => [T, Transferable[]];

const answers: { [task in keyof Answers]: Read<Answers[task]> } = { lists, check, correct, identify, run };

function lists(text: (k: number) => string): [Answers["lists"], Transferable[]] {
  return [JSON.parse(text(0)), []];
}

function check(text: (k: number) => string, bytes: (k: number) => Uint8Array<ArrayBuffer>): [Checked, Transferable[]] {
  const { findings, amounts_to, is_whole, machine } = JSON.parse(text(0));
  const points = new Float32Array(bytes(1).slice().buffer), kinds = new Uint32Array(bytes(2).slice().buffer);
  return [{ findings, amounts: amounts_to, isWhole: is_whole, machine, points, kinds }, [points.buffer, kinds.buffer]];
}

function correct(text: (k: number) => string): [Corrected, Transferable[]] {
  return [{ ...JSON.parse(text(0)), program: text(1) }, []];
}

function identify(text: (k: number) => string, bytes: (k: number) => Uint8Array<ArrayBuffer>): [Identified, Transferable[]] {
  return [{ ...JSON.parse(text(0)), file: text(1), page: new Blob([bytes(2)], { type: "text/html" }) }, []];
}

function run(text: (k: number) => string, bytes: (k: number) => Uint8Array<ArrayBuffer>): [RunAnswer, Transferable[]] {
  const results = JSON.parse(text(0)), { runs, remarks, verdict, limits } = JSON.parse(text(3)), data = JSON.parse(text(4));
  const cuts = data.runs.map((columns: Columns, k: number) =>
    cut(columns, data.meta, k, { figures: runs[k], worst: results.runs[k].worst, limits }));
  const transfer = cuts.flatMap((cut: Cut) =>
    [cut.t_s, cut.error_um, cut.line, cut.cutting, cut.foot_mm, cut.deviation_mm].map((column) => column.buffer));
  return [{ cuts, remarks, verdict, report: new Blob([bytes(2)], { type: "text/html" }) }, transfer];
}

type Columns = { [name: string]: number[] };
interface Meta { units: { time_s: number; point_mm: number }; runs: { error_mm: number }[] }

/** A run of what is drawn, see crates/feedwright/src/report/embedded_data.rs. */
function cut(columns: Columns, { units, runs }: Meta, k: number, rest: Pick<Cut, "figures" | "worst" | "limits">): Cut {
  const n = columns.t.length, error_mm = runs[k].error_mm;
  // Three columns beside each other.
  const vectors = (prefix: string, unit: number) => {
    const all = new Float32Array(3 * n);
    ["x", "y", "z"].forEach((axis, a) => decode(columns[prefix + axis] ?? [], unit).forEach((mm, i) => (all[3 * i + a] = mm)));
    return all;
  };
  return {
    ...rest, look: `run-${k}`, foot_mm: vectors("f", units.point_mm), deviation_mm: vectors("d", error_mm),
    t_s: new Float32Array(decode(columns.t, units.time_s)),
    error_um: new Float32Array(decode(columns.e, 1e3 * error_mm)),
    line: new Uint32Array(decode(columns.line, 1)),
    cutting: new Uint8Array(decode(columns.cutting, 1)),
  };
}
