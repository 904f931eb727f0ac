// Runs parts/star.ngc on workshop in the WebAssembly module, and beside it natively:
//   node star.test.mjs MODULE.wasm RESULTS.json TRACE.csv      the latter two of `feedwright run parts/star.ngc --machine workshop`
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { performance } from "node:perf_hooks";

const [modulePath, resultsPath, tracePath] = process.argv.slice(2);
const bytes = await readFile(modulePath);
const module = await WebAssembly.compile(bytes);
const imported = WebAssembly.Module.imports(module).map(({ module: from, name, kind }) => `${kind} ${from}.${name}`);
assert.deepEqual(imported.sort(), ["cut", "find", "keep", "progress", "take"].map((name) => `function page.${name}`), "the module needs something else from outside");

async function answer(request) {
  const told = { stages: [], points: 0 };
  const page = {
    progress: (at, length) => told.stages.push(new TextDecoder().decode(new Uint8Array(exports.memory.buffer, at, length))),
    cut: (at, count) => (told.points += count),
    find: () => -1,
    take: () => undefined,
    keep: () => undefined,
  };
  const { exports } = await WebAssembly.instantiate(module, { page });
  const { program = "", ...asked } = request;
  for (const [text, room] of [[program, exports.program], [JSON.stringify(asked), exports.input]]) {
    const bytes = new TextEncoder().encode(text);
    // Room may make the memory grow, and its buffer is another one then.
    const at = room(bytes.length);
    new Uint8Array(exports.memory.buffer, at, bytes.length).set(bytes);
  }
  const began = performance.now();
  const succeeded = exports.run() === 1;
  const seconds = (performance.now() - began) / 1000;
  const output = (k) =>
    new TextDecoder().decode(new Uint8Array(exports.memory.buffer, exports.at(k), exports.length(k)));
  return { succeeded, seconds, megabytes: exports.memory.buffer.byteLength / 1e6, outputs: [0, 1, 2, 3].map(output), told };
}

const program = await readFile(new URL("../../parts/star.ngc", import.meta.url), "utf8");
const star = { name: "star.ngc", program, machine: "workshop", rows: true };
const cut = await answer(star);
assert.ok(cut.succeeded, cut.outputs[0]);

// Its figures are the figures of the command, bit for bit.
const [here, native] = [JSON.parse(cut.outputs[0]), JSON.parse(await readFile(resultsPath, "utf8"))];
assert.equal(here.runs.length, 2);
here.runs.forEach((run, k) => {
  for (const key of ["time_s", "rms_um", "max_um", "uncut_um", "peak_torque_nm"]) {
    assert.deepEqual(run[key], native.runs[k][key], `${run.controller}, ${key}`);
  }
});
assert.ok(here.runs[1].rms_um < 0.5 * here.runs[0].rms_um, "the correction does nothing");

// And so are its rows, which have all digits.
const [rows, nativeRows] = [cut.outputs[1], await readFile(tracePath, "utf8")].map((text) => text.split("\n"));
assert.equal(rows.length, nativeRows.length);
rows.forEach((row, k) => assert.equal(row, nativeRows[k], `row ${k}`));

// The page hears of both cuts, and can draw the second.
for (const cutting of ["cutting, uncorrected", `cutting, ${here.runs[1].controller}`]) {
  assert.ok(cut.told.stages.includes(cutting), `${cutting} is not told`);
}
assert.ok(cut.told.points > 500, `${cut.told.points} points`);

// The same input gives the same bits, in a module of its own.
assert.deepEqual((await answer(star)).outputs, cut.outputs);

// What is wrong is told as the command tells it.
const refused = async (change, said) => {
  const { succeeded, outputs } = await answer({ ...star, ...change });
  assert.ok(!succeeded && outputs[0].includes(said), outputs[0]);
};
await refused({ program: "G1 X1 F100 Q\n" }, "1 mistake, nothing was cut");
await refused({ machine: "none" }, "none");
await refused({ machine: "name = 1\n" }, "machine");
await refused({ controller: "none" }, "no controller is called 'none'");
await refused({ tolerance_um: -1 }, "tolerance");
await refused({ surplus: 1 }, "surplus");
await refused({ task: "correct", target: "none" }, "no control is called 'none'");

// The mistakes of a program have their places, and its path goes as far as the first of them.
const checked = await answer({ task: "check", name: "a.ngc", program: "G21 G90 F600\nG1 X10\nG1 X20 Q\nG1 X30\nM2\n" });
assert.ok(checked.succeeded, checked.outputs[0]);
const { findings, amounts_to, is_whole } = JSON.parse(checked.outputs[0]);
assert.deepEqual([findings.length, findings[0].line, findings[0].severity, amounts_to, is_whole], [1, 3, "error", null, false]);

// A corrected program is better, by the figures of the command.
const corrected = await answer({ ...star, task: "correct", rows: false });
assert.ok(corrected.succeeded, corrected.outputs[0]);
const [before, after] = JSON.parse(corrected.outputs[0]).figures;
assert.ok(Number(after.rms_um) < 0.5 * Number(before.rms_um), corrected.outputs[0]);
assert.ok(corrected.outputs[1].includes("corrected by feedwright"));

console.log(
  `module ${(bytes.length / 1e6).toFixed(2)} MB, ${cut.seconds.toFixed(2)} s, ${cut.megabytes.toFixed(0)} MB of memory; ` +
    `${rows.length} rows, the same bits as the native run`,
);
