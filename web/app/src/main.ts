// The page: what is asked for, what the engine answers, and where it is shown.

import "uplot/dist/uPlot.min.css";
import "./style.css";
import { showCards } from "./cards";
import { errorColor } from "./colors";
import { Curve } from "./curve";
import { $, element, fill, press, save } from "./dom";
import { listenToDrops } from "./drops";
import { Editor } from "./editor";
import { Cancelled, Engine, engineModule } from "./engine";
import { EXAMPLES } from "./examples";
import { listenToIdentified, showIdentified } from "./identified";
import type { Checked, Corrected, Cut, Figures, Finding, Lists, Place, RunAnswer } from "./messages";
import { Playback } from "./playback";
import { type Units, errorText, errorUnit, getUnits, lengthText, roundBytes, roundLength, setUnits } from "./units";
import { PathView, type Side } from "./view";

const view = new PathView($("view"));
const curve = new Curve($("curve"));
const editor = new Editor($("text"), $("gutter"));
const playback = new Playback($("play"), $("time"), $("speed"));
// What is typed is checked while a program is cut; the start has an engine of its own.
const [checker, cutter, drawer] = [new Engine(), new Engine(), new Engine()];

const machineSelect = $<HTMLSelectElement>("machine"), controllerSelect = $<HTMLSelectElement>("controller");
const exampleSelect = $<HTMLSelectElement>("example"), controlSelect = $<HTMLSelectElement>("control");

const state = {
  name: "program.ngc",
  lists: undefined as Lists | undefined,
  machineFile: undefined as { name: string; text: string } | undefined,
  checked: undefined as Checked | undefined,
  answer: undefined as RunAnswer | undefined,
  corrected: undefined as Corrected | undefined,
  /** What other cuts are compared with. */
  kept: undefined as Cut | undefined,
  shown: 0,
};

const FROM_FILE = "file";

// ---- What is asked for

function request() {
  const isFile = machineSelect.value === FROM_FILE && state.machineFile;
  return {
    name: state.name,
    program: editor.value,
    machine: isFile ? `${state.machineFile!.text}\n` : machineSelect.value,
    machine_name: isFile ? state.machineFile!.name : undefined,
  };
}

const today = () => new Date().toISOString().slice(0, 10);

/** Opens a program; `example` is its name where it is one. */
function openProgram(name: string, program: string, example = ""): Promise<void> {
  state.name = name;
  editor.value = program;
  exampleSelect.value = example;
  $("name").textContent = name;
  document.title = `${name} · feedwright`;
  $("welcome").hidden = true;
  view.fit();
  forget();
  keepInUrl();
  return check();
}

async function openExample(name: string): Promise<void> {
  const checked = openProgram(`${name}.ngc`, EXAMPLES[name].program, name);
  // An example has no mistakes: its cut does not wait for the check.
  await Promise.all([checked, run()]);
}

/** Most bytes of a file, as `feedwright open` serves it: a text of more does not fit into the memory of a browser. */
const FILE_BYTES = 2 ** 29;

async function openFiles(files: Iterable<File>): Promise<void> {
  for (const file of files) {
    try {
      if (file.size >= FILE_BYTES) throw new Error(`it has ${roundBytes(file.size)}, and a browser holds ${roundBytes(FILE_BYTES)}. Use the command: feedwright run`);
      const text = await file.text();
      if (/\.toml$/i.test(file.name)) openMachine(file.name, text);
      else if (/\.(csv|log|json)$/i.test(file.name)) await identify(file.name, text);
      else await openProgram(file.name, text);
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
async function identify(name: string, log: string): Promise<void> {
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
  $("findings").replaceChildren(...findings.slice(0, 200).map(findingRow));
  const amounts = checked?.amounts;
  const errors = findings.filter(({ severity }) => severity === "error").length;
  $("amounts").textContent = amounts
    ? `${amounts.lines} lines, ${amounts.motions} motions, ${roundLength(amounts.feed_mm)} of cuts, ${roundLength(amounts.rapid_mm)} of rapids. Read as ${amounts.dialect}.`
    : errors ? `${errors} mistake${errors === 1 ? "" : "s"}: nothing can be cut.` : "";
  enable();
}

function findingRow(finding: Finding): HTMLElement {
  const row = element("li", "", finding.severity), button = element("button");
  button.type = "button";
  button.append(element("b", `${finding.line}:${finding.column} ${finding.severity}`), ` ${finding.message}`);
  if (finding.hint) button.append(element("small", `hint: ${finding.hint}`));
  button.addEventListener("click", () => editor.go(finding));
  row.append(button);
  return row;
}

const largest_um = (cuts: Cut[]) => Math.max(...cuts.map(({ figures }) => Number(figures.max_um)).filter(Number.isFinite), 0);

function showAnswer(): void {
  const { answer } = state, cuts = answer?.cuts ?? [], all = compared();
  for (const id of ["figures", "report", "keep", "worst-title", "legend"]) $(id).hidden = !answer;
  $("keep").setAttribute("aria-pressed", String(!!state.kept));
  // What the correction costs stands in the report.
  $("verdict").textContent = answer?.verdict.split(" Cost:")[0] ?? "Run shows what the machine will cut without a correction and with the controller.";
  fillFigures($("figures"), all.map(({ figures }) => figures), all.map(({ look }) => look));
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

function fillFigures(table: HTMLElement, rows: Figures[], looks: string[] = []): void {
  table.querySelectorAll(".unit").forEach((unit) => (unit.textContent = errorUnit()));
  table.querySelector("tbody")!.replaceChildren(...rows.map((figures, k) => {
    const row = element("tr"), name = element("th", figures.name, looks[k] ? `run ${looks[k]}` : "");
    name.scope = "row";
    row.append(name, ...[figures.time_s, errorText(figures.rms_um), errorText(figures.max_um)].map((text) => element("td", text)));
    return row;
  }));
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
  $("largest").textContent = `${errorText(largest_um(cuts))} ${errorUnit()}`;
  $("worst").replaceChildren(...(cut?.worst ?? []).map((place) => worstRow(place)));
  showGain();
  view.describe(cut
    ? `Path of ${state.name}, ${cut.figures.name}: largest contour error ${errorText(cut.figures.max_um)} ${errorUnit()}. Arrow keys move, + and − zoom, 0 fits.`
    : `Path of ${state.name}`);
}

function worstRow(place: Place): HTMLElement {
  const row = element("li"), button = element("button");
  button.type = "button";
  button.append(element("b", `${errorText(Math.abs(place.error_um))} ${errorUnit()}`), element("span", `line ${place.line}`), element("code", place.text));
  button.addEventListener("click", () => {
    view.zoomTo(place.position_mm);
    playback.time(place.t_s);
    row.parentElement!.querySelectorAll("[aria-current]").forEach((old) => old.removeAttribute("aria-current"));
    button.setAttribute("aria-current", "true");
  });
  row.append(button);
  return row;
}

function showGain(): void {
  const gain = view.shownGain;
  $("gain-now").textContent = gain > 1 ? `errors drawn ${gain} times too large` : "";
}

function showCorrected(): void {
  const { corrected } = state;
  $("corrected").hidden = !corrected;
  if (!corrected) return;
  fillFigures($("corrected"), corrected.figures);
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

// ---- The address keeps what was chosen

function keepInUrl(): void {
  const { lists } = state;
  if (!lists) return;
  const chosen = new URLSearchParams();
  if (exampleSelect.value) chosen.set("example", exampleSelect.value);
  if (machineSelect.value !== FROM_FILE && machineSelect.value !== lists.machine) chosen.set("machine", machineSelect.value);
  if (controllerSelect.value !== lists.controller) chosen.set("controller", controllerSelect.value);
  if (controlSelect.value !== lists.control) chosen.set("control", controlSelect.value);
  if (getUnits() !== "mm") chosen.set("units", getUnits());
  history.replaceState(null, "", chosen.size ? `#${chosen}` : location.pathname);
}

function takeFromUrl(): string {
  const chosen = new URLSearchParams(location.hash.slice(1));
  const choose = (select: HTMLSelectElement, name: string) => {
    const value = chosen.get(name);
    if (value && [...select.options].some((option) => option.value === value)) select.value = value;
  };
  choose(machineSelect, "machine");
  choose(controllerSelect, "controller");
  choose(controlSelect, "control");
  if (chosen.get("units") === "in") useUnits("in");
  const example = chosen.get("example") ?? "";
  return Object.hasOwn(EXAMPLES, example) ? example : "";
}

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
    exampleSelect.value = "";
    $("welcome").hidden = true;
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      forget();
      keepInUrl();
      void check();
    }, 200);
  };
  for (const select of [machineSelect, controllerSelect])
    select.addEventListener("change", () => {
      forget();
      keepInUrl();
      void check();
    });
  controlSelect.addEventListener("change", () => {
    state.corrected = undefined;
    showCorrected();
    keepInUrl();
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
    keepInUrl();
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
    $("scale").textContent = state.checked ? `grid ${roundLength(apart_mm)} · ${axes}` : "";
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

/** Opens the files that `feedwright open` was given. A server that has none keeps its address: the page then works without it, too. */
async function servedFiles(): Promise<void> {
  const names: string[] | null = await (await fetch("files.json")).json();
  if (!names) return void navigator.serviceWorker?.register("offline.js").catch(() => {});
  const files = names.map(async (name, k) => new File([await (await fetch(`files/${k}`)).blob()], name));
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
    const example = takeFromUrl();
    await servedFiles();
    if (example && !editor.value) await openExample(example);
    else if (!editor.value) await showCards(drawer, openExample);
    else if (!state.checked) await check();
  } catch (error) {
    say(`The engine does not start: ${(error as Error).message}. Load the page again.`);
  }
  drawer.cancel();
}

// For tests and measurements.
Object.assign(globalThis, { feedwright: { view } });

void start();
