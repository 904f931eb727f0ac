// The engine seen from the page: requests to a worker, which can be ended.

import type { Answers, EngineRequest, FromWorker, ToWorker } from "./messages";

export interface Listener {
  progress?(stage: string, part: number): void;
  points?(points: Float32Array): void;
}

interface Waiting { resolve(answer: unknown): void; reject(error: Error): void; listener: Listener }

let compiled: Promise<WebAssembly.Module> | undefined;

/** Fetches and compiles the engine, once. */
export function engineModule(): Promise<WebAssembly.Module> {
  compiled ??= fetched("engine.wasm.gz").then((bytes) => WebAssembly.compile(bytes));
  return compiled;
}

/** A file that was packed with gzip; some servers unpack it themselves. */
async function fetched(name: string): Promise<ArrayBuffer> {
  const response = await fetch(name);
  if (!response.ok) throw new Error(`${name} is missing: ${response.status}`);
  const bytes = await response.arrayBuffer(), head = new Uint8Array(bytes, 0, 2);
  if (head[0] !== 0x1f || head[1] !== 0x8b) return bytes;
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
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
      worker.postMessage({ id, module, request } satisfies ToWorker);
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
