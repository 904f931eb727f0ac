// The page: what is asked for, what the engine answers, and where it is shown.

import "uplot/dist/uPlot.min.css";
import "../../../crates/feedwright/assets/report/colors.css";
import "./style.css";
import { FROM_FILE, keepInUrl, takeFromUrl } from "./address";
import { showCards } from "./cards";
import { errorColor } from "../../../crates/feedwright/assets/report/theme.js";
import { Curve } from "./curve";
import { $, element, fill, press, save } from "./dom";
import { listenToDrops } from "./drops";
import { Editor } from "./editor";
import { Cancelled, Engine, engineModule } from "./engine";
import { EXAMPLES } from "./examples";
import { listenToIdentified, showIdentified } from "./identified";
import type { Checked, Corrected, Cut, Lists, RunAnswer } from "./messages";
import { Live } from "./live";
import { Playback } from "./playback";
import { fillTable, findingRow, numbersOf, placeRow, slowestLines } from "./rows";
import { NAME as MACHINE_NAME, listenToQuestions } from "./questions";
import { type Units, errorText, errorUnit, getUnits, lengthText, roundBytes, roundLength, setUnits } from "./units";
import { PathView, type Side } from "./view";

const view = new PathView($("view"));
const curve = new Curve($("curve"));
const editor = new Editor($("text"), $("gutter"));
const live = new Live();
const playback = new Playback($("play"), $("time"), $("speed"));
// What is typed is checked while a program is cut; the start has an engine of its own.
const [checker, cutter, drawer] = [new Engine(), new Engine(), new Engine()];

const machineSelect = $<HTMLSelectElement>("machine"), controllerSelect = $<HTMLSelectElement>("controller");
const exampleSelect = $<HTMLSelectElement>("example"), controlSelect = $<HTMLSelectElement>("control");

/** Lines that take longest, of which so many are listed. */
const LISTED = 5;

const state = {
  name: "program.ngc",
  /** Its name in the folder `parts`, where it comes from there. */
  part: "",
  lists: undefined as Lists | undefined,
  file: undefined as Blob | undefined,
  machineFile: undefined as { name: string; text: string } | undefined,
  checked: undefined as Checked | undefined,
  answer: undefined as RunAnswer | undefined,
  corrected: undefined as Corrected | undefined,
  /** What other cuts are compared with. */
  kept: undefined as Cut | undefined,
  shown: 0,
};

// ---- What is asked for

function request() {
  const isFile = machineSelect.value === FROM_FILE && state.machineFile;
  return {
    name: state.name,
    // What is too long to be edited is what the file holds.
    program: (editor.isLong && state.file) || editor.value,
    machine: isFile ? `${state.machineFile!.text}\n` : machineSelect.value,
    machine_name: isFile ? state.machineFile!.name : undefined,
  };
}

const today = () => new Date().toISOString().slice(0, 10);

/** Opens a program: one of the user, an example, or a part that stands beside the page. */
function openProgram(name: string, program: string, { example = "", part = "", file = undefined as Blob | undefined } = {}): Promise<void> {
  [state.name, state.part, state.file] = [name, part, file];
  editor.value = program;
  exampleSelect.value = example;
  $("name").textContent = name;
  document.title = `${name} · feedwright`;
  $("welcome").hidden = true;
  view.fit();
  forget();
  keep();
  return check();
}

/** Opens what has no mistakes: its cut does not wait for the check. */
async function openAndRun(...program: Parameters<typeof openProgram>): Promise<void> {
  await Promise.all([openProgram(...program), run()]);
}

const openExample = (name: string) => openAndRun(`${name}.ngc`, EXAMPLES[name].program, { example: name });

async function openPart(part: string): Promise<void> {
  const answer = await fetch(`parts/${part}`);
  if (answer.ok) await openAndRun(part, await answer.text(), { part });
  else say(`parts/${part} is not there.`);
}

const keep = () => state.lists && keepInUrl(state.lists, state.part);

/** Most bytes of a file, as `feedwright open` serves it: a text of more does not fit into the memory of a browser. */
const FILE_BYTES = 2 ** 29;

async function openFiles(files: Iterable<File>): Promise<void> {
  for (const file of files) {
    try {
      if (file.size >= FILE_BYTES) throw new Error(`it has ${roundBytes(file.size)}, and a browser holds ${roundBytes(FILE_BYTES)}. Use the command: feedwright run`);
      if (/\.toml$/i.test(file.name)) openMachine(file.name, await file.text());
      else if (/\.(csv|log|json)$/i.test(file.name)) await identify(file.name, file);
      else await openProgram(file.name, await file.text(), { file });
    } catch (error) {
      say(`${file.name} cannot be opened: ${(error as Error).message}`);
    }
  }
}

function openMachine(name: string, text: string): void {
  state.machineFile = { name, text };
  machineSelect.querySelector(`[value=${FROM_FILE}]`)?.remove();
  machineSelect.prepend(new Option(name, FROM_FILE));
  machineSelect.value = FROM_FILE;
  forget();
  void check();
}

/** Results of another program or machine are none of this one. */
function forget(): void {
  cutter.cancel();
  [state.answer, state.corrected, state.shown] = [undefined, undefined, 0];
  say("");
  showAnswer();
  showCorrected();
}

// ---- The engine

let lastCheck = 0;

async function check(): Promise<void> {
  const number = ++lastCheck;
  checker.cancel();
  // The start checks what was typed before the machines were there.
  if (!state.lists || !editor.value.trim()) {
    state.checked = undefined;
    showChecked();
    return;
  }
  const slow = setTimeout(() => ($("amounts").textContent = "Reading the program. If it does not end, change it, or press Esc."), 2000);
  try {
    const checked = await checker.ask({ ...request(), task: "check" });
    if (number !== lastCheck) return;
    state.checked = checked;
    showChecked();
  } catch (error) {
    if (number !== lastCheck) return;
    $("amounts").textContent = "";
    if (!(error instanceof Cancelled)) say(String((error as Error).message));
  } finally {
    clearTimeout(slow);
  }
}

/** Does long work of the cutter, with progress and an end. */
async function work(act: (progress: (stage: string, part: number) => void) => Promise<void>): Promise<void> {
  cutter.cancel();
  say("");
  let began = performance.now(), last = "";
  const progress = (stage: string, part: number) => {
    if (stage !== last) [last, began] = [stage, performance.now()];
    const left_s = ((performance.now() - began) / 1000) * (1 / part - 1);
    $("stage").textContent = stage;
    $<HTMLProgressElement>("bar").value = part;
    $("left").textContent = part > 0.05 && part < 1 && left_s >= 1 ? `${Math.ceil(left_s)} s left in this step` : "";
  };
  busy(true);
  progress("starting", 0);
  try {
    await act(progress);
  } catch (error) {
    // Other work may have begun, which is busy now.
    if (error instanceof Cancelled) return;
    say(String((error as Error).message));
  }
  busy(false);
}

async function run(): Promise<void> {
  await work(async (progress) => {
    view.cut(undefined, 1);
    const asked = { ...request(), task: "run" as const, controller: controllerSelect.value, recorded_on: today(), page: true };
    state.answer = await cutter.ask(asked, { progress, points: (points) => view.add(points) });
    showAnswer();
  });
  if (!state.answer) view.cut(undefined, 1);
}

async function correct(): Promise<void> {
  await work(async (progress) => {
    state.corrected = await cutter.ask({ ...request(), task: "correct", target: controlSelect.value }, { progress });
    showCorrected();
  });
}

/** Finds the machine by its log, and cuts on it from then on. */
async function identify(name: string, log: Blob): Promise<void> {
  await work(async (progress) => {
    const stem = name.replace(/\.[^.]*$/, ""), identified = await cutter.ask({ task: "identify", name, program: log }, { progress });
    openMachine(`${stem}.toml`, identified.file);
    showIdentified(stem, name, identified);
  });
}

function cancel(): void {
  checker.cancel();
  cutter.cancel();
  busy(false);
  if (!state.answer) view.cut(undefined, 1);
}

function busy(now: boolean): void {
  $("work").hidden = !now;
  document.body.classList.toggle("busy", now);
  enable();
}

function enable(): void {
  const isFine = !!state.lists && !!state.checked?.amounts && $("work").hidden;
  for (const id of ["run", "correct"]) $<HTMLButtonElement>(id).disabled = !isFine;
}

function say(message: string): void {
  $("message").textContent = message;
  $("message").hidden = !message;
}

// ---- What is shown

function showChecked(): void {
  const { checked } = state, findings = checked?.findings ?? [];
  if (checked) view.program(checked);
  editor.mark(findings);
  $("findings").replaceChildren(...findings.slice(0, 200).map((finding) => findingRow(finding, () => editor.go(finding))));
  const amounts = checked?.amounts;
  const errors = findings.filter(({ severity }) => severity === "error").length;
  $("amounts").textContent = amounts
    ? `${amounts.lines} lines, ${amounts.motions} motions, ${roundLength(amounts.feed_mm)} of cuts, ${roundLength(amounts.rapid_mm)} of rapids. Read as ${amounts.dialect}.`
    : errors ? `${errors} mistake${errors === 1 ? "" : "s"}: nothing can be cut.` : "";
  enable();
}

const largest_um = (cuts: Cut[]) => Math.max(...cuts.map(({ figures }) => Number(figures.max_um)).filter(Number.isFinite), 0);

function showAnswer(): void {
  const { answer } = state, cuts = answer?.cuts ?? [], all = compared();
  for (const id of ["figures", "report", "keep", "live-show"]) $(id).hidden = !answer;
  $("keep").setAttribute("aria-pressed", String(!!state.kept));
  // What the correction costs stands in the report.
  $("verdict").textContent = answer?.verdict.split(" Cost:")[0] ?? "Run shows what the machine will cut without a correction and with the controller.";
  fillTable($("figures"), all.map(({ figures, look }) => ({ ...numbersOf(figures), look })));
  $("shown").replaceChildren(...cuts.map(({ figures }, k) => {
    const button = element("button", figures.name);
    button.type = "button";
    button.addEventListener("click", () => showCut(k));
    return button;
  }));
  curve.show(all);
  $("key").replaceChildren(element("b", "Contour error over time"), ...all.map(({ figures, look }) => element("span", figures.name, `run ${look}`)));
  showCut(Math.min(state.shown, Math.max(0, cuts.length - 1)));
}

/** The cuts that are there, and the one that was kept where it is another. */
function compared(): Cut[] {
  const { answer, kept } = state;
  if (!answer || !kept) return answer?.cuts ?? [];
  return answer.cuts.some(({ t_s }) => t_s === kept.t_s) ? answer.cuts : [...answer.cuts, kept];
}

/** Keeps the cut that is shown, or drops the one that was kept. */
function keepCut(): void {
  const cut = state.answer?.cuts[state.shown], name = `${cut?.figures.name} before: ${state.name} on ${machineSelect.selectedOptions[0].text}`;
  state.kept = state.kept || !cut ? undefined : { ...cut, look: "kept", figures: { ...cut.figures, name } };
  showAnswer();
}

/** Shows one of the cuts: its path, its worst places, its playback. */
function showCut(k: number): void {
  state.shown = k;
  const cuts = state.answer?.cuts ?? [], cut = cuts[k];
  [...$("shown").children].forEach((button, i) => button.setAttribute("aria-pressed", String(i === k)));
  view.cut(cut, largest_um(cuts));
  view.compare(compared()[cuts.length]);
  playback.show(cut);
  $("readout").textContent = "";
  showPlaces(cut);
  showLegend(largest_um(cuts));
  view.describe(cut
    ? `Path of ${state.name}, ${cut.figures.name}: largest contour error ${errorText(cut.figures.max_um)} ${errorUnit()}. Arrow keys move, + and − zoom, 0 fits.`
    : `Path of ${state.name}`);
}

/** Lists worst places, what the supervisor did, the lines that take longest, and what binds. */
function showPlaces(cut: Cut | undefined): void {
  const list = (id: string, rows: HTMLElement[]) => {
    $(id).replaceChildren(...rows);
    $(`${id}-title`).hidden = !rows.length;
  };
  list("worst", (cut?.worst ?? []).map(({ error_um, line, text, position_mm, t_s }) =>
    placeRow(`${errorText(Math.abs(error_um))} ${errorUnit()}`, line, text, () => {
      view.zoomTo(position_mm);
      playback.time(t_s);
    })));
  list("record", (cut?.figures.record ?? []).map(({ t_s, line, text }) => placeRow(`${t_s.toFixed(3)} s`, line, text, () => playback.time(t_s))));
  const texts = editor.isLong ? [] : editor.value.split("\n"), slowest = cut ? slowestLines(cut, LISTED) : [];
  list("slow", slowest.map(({ line, time_s, t_s }) => placeRow(`${time_s.toFixed(3)} s`, line, texts[line - 1]?.trim() ?? "", () => playback.time(t_s))));
  list("limits", (cut?.limits ?? []).map(([name, percent, line]) => placeRow(`${Math.round(percent)} %`, line, name, () => playback.time(cut!.t_s[cut!.line.indexOf(line)]))));
}

function showLegend(largest_um: number): void {
  $("legend").hidden = !largest_um;
  $("largest").textContent = `${errorText(largest_um)} ${errorUnit()}`;
  showGain();
}

function showGain(): void {
  const gain = view.shownGain;
  $("gain-now").textContent = gain > 1 ? `errors drawn ${gain} times too large` : "";
}

function showCorrected(): void {
  const { corrected } = state;
  $("corrected").hidden = !corrected;
  if (!corrected) return;
  fillTable($("corrected"), corrected.figures.map(numbersOf));
  const { refusal, hint, stretches, stretches_changed, rounds } = corrected;
  $("correction").textContent = refusal
    ? `No corrected program: ${refusal}.${hint ? ` Hint: ${hint}.` : ""}`
    : `${stretches_changed} of ${stretches} stretches between corners were changed, found in ${rounds} simulated cuts. Both cut without feedback, as the control plans them.`;
  for (const id of ["download", "take"]) $(id).hidden = !corrected.program || !!refusal;
}

function showTool(index: number): void {
  const cut = state.answer?.cuts[state.shown];
  if (!cut) return;
  view.tool(index);
  curve.tool(cut.t_s[index]);
  editor.current(cut.line[index]);
  const position = [0, 1, 2].map((a) => lengthText(cut.foot_mm[3 * index + a] + cut.deviation_mm[3 * index + a]));
  const error = cut.cutting[index] ? `error ${errorText(Math.abs(cut.error_um[index]))} ${errorUnit()}` : "rapid or rest";
  $("readout").textContent = `${cut.t_s[index].toFixed(3)} s   line ${cut.line[index]}   X ${position[0]}  Y ${position[1]}  Z ${position[2]} ${getUnits()}   ${error}`;
}

function drawLegend(): void {
  const canvas = $<HTMLCanvasElement>("colors"), g = canvas.getContext("2d")!;
  for (let x = 0; x < canvas.width; x++) {
    g.fillStyle = errorColor(x / canvas.width);
    g.fillRect(x, 0, 1, canvas.height);
  }
}

const stem = () => state.name.replace(/\.[^.]*$/, "");

function useUnits(units: Units): void {
  setUnits(units);
  press("[data-units]", (button) => button.dataset.units === units);
}

// ---- The start

function listen(): void {
  $("open").addEventListener("click", () => $("file").click());
  $<HTMLInputElement>("file").addEventListener("change", (event) => {
    const input = event.target as HTMLInputElement;
    void openFiles([...(input.files ?? [])]).then(() => (input.value = ""));
  });
  exampleSelect.addEventListener("change", () => exampleSelect.value && openExample(exampleSelect.value));
  let waiting = 0;
  editor.onChange = () => {
    exampleSelect.value = state.part = "";
    $("welcome").hidden = true;
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      forget();
      keep();
      void check();
    }, 200);
  };
  for (const select of [machineSelect, controllerSelect])
    select.addEventListener("change", () => {
      forget();
      keep();
      void check();
    });
  controlSelect.addEventListener("change", () => {
    state.corrected = undefined;
    showCorrected();
    keep();
  });
  $("run").addEventListener("click", () => void run());
  $("correct").addEventListener("click", correct);
  $("cancel").addEventListener("click", cancel);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) $("run").click();
    else if (event.key === "Escape") cancel();
  });
  listenToResults();
  listenToIdentified();
  listenToView();
  listenToDrops(openFiles);
  listenToQuestions((text) => openMachine(MACHINE_NAME, text));
}

function listenToResults(): void {
  $("report").addEventListener("click", () => state.answer && save(`${stem()}.report.html`, state.answer.report));
  $("keep").addEventListener("click", keepCut);
  const program = () => new Blob([state.corrected!.program], { type: "text/plain" });
  $("download").addEventListener("click", () => state.corrected && save(`${stem()}.corrected.ngc`, program()));
  $("take").addEventListener("click", () => state.corrected && openProgram(`${stem()}.corrected.ngc`, state.corrected.program));
}

function listenToView(): void {
  document.querySelectorAll<HTMLElement>("[data-units]").forEach((button) => button.addEventListener("click", () => {
    useUnits(button.dataset.units as Units);
    keep();
    showChecked();
    showAnswer();
    showCorrected();
  }));
  document.querySelectorAll<HTMLElement>("[data-side]").forEach((button) => button.addEventListener("click", () => {
    view.side(button.dataset.side as Side);
    press("[data-side]", (other) => other === button);
  }));
  $("fit").addEventListener("click", () => view.fit());
  $<HTMLSelectElement>("gain").addEventListener("change", (event) => {
    view.gain = Number((event.target as HTMLSelectElement).value);
    view.regain();
    showGain();
  });
  view.onGrid = (apart_mm, side) => {
    const axes = { top: "X right, Y up", front: "X right, Z up", right: "Y right, Z up", iso: "from the front left, above" }[side];
    $("scale").textContent = state.checked || !$("live").hidden ? `grid ${roundLength(apart_mm)} · ${axes}` : "";
  };
  view.onPick = (index) => {
    playback.stop();
    playback.index(index);
  };
  curve.onPick = (t_s) => {
    playback.stop();
    playback.time(t_s);
  };
  playback.onMove = showTool;
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    drawLegend();
    view.redraw();
    curve.show(compared());
  });
}

/** Shows the machine itself, as long as nothing simulated is shown. */
function watchMachine(): void {
  $("welcome").hidden = true;
  $("live-show").addEventListener("click", forget);
  live.onRows = (path, errors) => {
    if (state.answer || !$("work").hidden) return;
    const largest = largest_um([path]);
    if (!state.checked) view.program({ points: path.foot_mm, kinds: new Uint32Array(path.line.length) });
    view.cut(path, largest);
    view.tool(path.line.length - 1);
    view.describe("Path of the machine. Arrow keys move, + and − zoom, 0 fits.");
    curve.show(errors);
    showLegend(largest);
    // Only of the simulated cut it is known where the error points.
    $("gain-now").textContent = "";
  };
  void live.start();
}

/** Opens the files that `feedwright open` was given. A server that has none keeps its address: the page then works without it, too. */
async function servedFiles(): Promise<void> {
  const served: { files: string[]; hal: boolean } | null = await (await fetch("files.json")).json();
  if (!served) return void navigator.serviceWorker?.register("offline.js").catch(() => {});
  if (served.hal) watchMachine();
  const files = served.files.map(async (name, k) => new File([await (await fetch(`files/${k}`)).blob()], name));
  await openFiles(await Promise.all(files));
}

async function start(): Promise<void> {
  listen();
  drawLegend();
  for (const [name, { about }] of Object.entries(EXAMPLES)) exampleSelect.append(Object.assign(new Option(name, name), { title: about }));
  try {
    await engineModule();
    // Typing cancels the checker, and must not end this.
    const lists = (state.lists = await drawer.ask({ task: "lists" }));
    fill(machineSelect, lists.machines, lists.machine);
    fill(controllerSelect, lists.controllers, lists.controller);
    fill(controlSelect, lists.controls, lists.control);
    $("version").textContent = `feedwright ${lists.version}.`;
    const { example, part, units } = takeFromUrl();
    useUnits(units);
    await servedFiles();
    if (Object.hasOwn(EXAMPLES, example) && !editor.value) await openExample(example);
    else if (part && !editor.value) await openPart(part);
    else if (!editor.value && !$("welcome").hidden) await showCards(drawer, openExample);
    else if (!state.checked) await check();
  } catch (error) {
    say(`The engine does not start: ${(error as Error).message}. Load the page again.`);
  }
  drawer.cancel();
}

// For tests and measurements.
Object.assign(globalThis, { feedwright: { view } });

void start();
