// The engine seen from the page: requests to a worker, which can be ended.

import type { Answers, EngineRequest, FromWorker, ToWorker } from "./messages";

export interface Listener {
  progress?(stage: string, part: number): void;
  points?(points: Float32Array): void;
}

interface Waiting { resolve(answer: unknown): void; reject(error: Error): void; listener: Listener }

let compiled: Promise<WebAssembly.Module> | undefined, digest = "";

/** Fetches and compiles the engine, once. */
export function engineModule(): Promise<WebAssembly.Module> {
  compiled ??= fetchAndCompile("engine.wasm.gz");
  return compiled;
}

/** Compiles while the download comes. */
async function fetchAndCompile(name: string): Promise<WebAssembly.Module> {
  const response = await fetch(name);
  if (!response.ok || !response.body) throw new Error(`${name} is missing: ${response.status}`);
  // Only pages from this computer or by https have it.
  const hash = crypto.subtle && response.clone().arrayBuffer().then((all) => crypto.subtle.digest("SHA-256", all));
  const reader = response.body.getReader(), first = await reader.read();
  const bytes = new ReadableStream<BufferSource>({
    start: (into) => first.value ? into.enqueue(first.value) : into.close(),
    pull: async (into) => {
      const { done, value } = await reader.read();
      if (done) into.close();
      else into.enqueue(value);
    },
  });
  // Some servers unpack what was packed with gzip themselves.
  const isPacked = first.value?.[0] === 0x1f && first.value[1] === 0x8b;
  const module = isPacked ? bytes.pipeThrough(new DecompressionStream("gzip")) : bytes;
  const engine = await WebAssembly.compileStreaming(new Response(module, { headers: { "Content-Type": "application/wasm" } }));
  if (hash) digest = [...new Uint8Array(await hash)].map((byte) => byte.toString(16)).join("-");
  return engine;
}

export class Cancelled extends Error {}

/** One worker. */
export class Engine {
  #worker: Worker | undefined;
  #waiting = new Map<number, Waiting>();
  #last = 0;

  async ask<T extends keyof Answers>(request: EngineRequest & { task: T }, listener: Listener = {}): Promise<Answers[T]> {
    const module = await engineModule();
    const worker = (this.#worker ??= this.#start()), id = ++this.#last;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve: resolve as (answer: unknown) => void, reject, listener });
      worker.postMessage({ id, module, engine: digest, request } satisfies ToWorker);
    });
  }

  /** Ends what is under way. */
  cancel(): void {
    this.#worker?.terminate();
    this.#worker = undefined;
    const all = [...this.#waiting.values()];
    this.#waiting.clear();
    all.forEach((waiting) => waiting.reject(new Cancelled("cancelled")));
  }

  #start(): Worker {
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module", name: "engine" });
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      const waiting = this.#waiting.get(data.id);
      if (!waiting) return;
      if (data.kind === "progress") waiting.listener.progress?.(data.stage, data.part);
      else if (data.kind === "points") waiting.listener.points?.(data.points);
      else {
        this.#waiting.delete(data.id);
        if (data.kind === "done") waiting.resolve(data.answer);
        else waiting.reject(new Error(data.reason));
      }
    };
    worker.onerror = (event) => {
      this.#waiting.forEach((waiting) => waiting.reject(new Error(event.message || "the engine does not start")));
      this.#waiting.clear();
    };
    return worker;
  }
}
