// The page in a browser, as `feedwright open` serves it:
//   node page.test.mjs FEEDWRIGHT TABLE [NAME]      TABLE: what `feedwright run parts/star.ngc` prints; NAME: a part of the name of a test
// Where SCREENSHOTS names a folder, the pictures go there.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, rename, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const [command, tablePath, part = ""] = process.argv.slice(2);
const PATIENCE_MS = 180_000;
const DIST = new URL("../dist/", import.meta.url).pathname;
const star = new URL("../../parts/star.ngc", import.meta.url).pathname;

/** Starts the command; its address comes first. */
function open(given = [], environment = {}) {
  const options = { stdio: ["ignore", "pipe", "inherit"], env: { ...process.env, ...environment } };
  const child = spawn(command, ["open", "--no-browser", "--quiet", ...given], options);
  const address = new Promise((resolve, reject) => {
    child.stdout.once("data", (text) => resolve(String(text).trim()));
    child.once("exit", (code) => reject(new Error(`feedwright open ended with ${code}`)));
  });
  return { child, address };
}

/** The page on a server that knows nothing of feedwright. `change` gives other bytes in place of a file's. */
async function host({ folder = DIST, port = 0, change = (name, bytes) => bytes } = {}) {
  const types = { html: "text/html", css: "text/css", js: "text/javascript", json: "application/json" };
  const server = createServer(async ({ url }, answer) => {
    const name = new URL(url, "http://a").pathname.slice(1) || "index.html";
    const bytes = await readFile(join(folder, name)).catch(() => undefined);
    answer.writeHead(bytes ? 200 : 404, { "Content-Type": types[name.split(".").pop()] ?? "application/octet-stream" });
    answer.end(bytes && change(name, bytes));
  });
  await new Promise((listening) => server.listen(port, "127.0.0.1", listening));
  const end = () => new Promise((ended) => {
    server.close(ended);
    server.closeAllConnections();
  });
  ({ port } = server.address());
  return { address: `http://127.0.0.1:${port}/`, port, end };
}

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
const served = [open(), open([star])];
const [address, withFile] = await Promise.all(served.map((one) => one.address));
const faults = [];

async function visit(at, options = {}, prepare = async () => {}) {
  const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, colorScheme: "light", acceptDownloads: true, ...options });
  page.setDefaultTimeout(PATIENCE_MS);
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("request", (request) => {
    if (!request.url().startsWith(at.split("#")[0]) && !/^(blob|data):/.test(request.url())) faults.push(`asks for ${request.url()}`);
  });
  await prepare(page);
  await page.goto(at);
  return page;
}

const seen = (page, selector) => page.waitForSelector(selector, { state: "visible" });
const cells = (page, table) => page.$$eval(`${table} tbody tr`, (rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));
const picture = (page, name) => process.env.SCREENSHOTS && page.screenshot({ path: `${process.env.SCREENSHOTS}/${name}.png` });
const drop = (page, name, text) => page.evaluate(([name, text]) => {
  const data = new DataTransfer();
  data.items.add(new File([text], name));
  dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
}, [name, text]);
async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  return [download.suggestedFilename(), await readFile(await download.path(), "utf8")];
}

const tests = {
  async "a first visit shows the examples, and a click cuts one with the figures of the command"() {
    const page = await visit(address);
    await seen(page, "#cards button");
    assert.equal(await page.locator("#cards button").count(), 4);
    await picture(page, "first");
    await page.click("[data-example=star]");
    await seen(page, "#figures");
    const table = (await readFile(tablePath, "utf8")).split("\n");
    for (const [name, ...figures] of await cells(page, "#figures")) {
      const row = table.find((line) => line.trim().startsWith(name) && line.includes(figures[0]));
      assert.deepEqual(row?.trim().split(/\s+/).slice(1, 4), figures, `${name}: ${row}`);
    }
    assert.match(page.url(), /#example=star$/);
    await picture(page, "star");
    // A worst place is shown, with its line.
    await page.click("#worst button >> nth=0");
    assert.match(await page.textContent("#readout"), /line \d+ .*error \d/);
    // In inches the figures are thousandths.
    await page.click("[data-units=in]");
    const [[, , rms]] = await cells(page, "#figures");
    assert.ok(Math.abs(Number(rms) * 25.4 - Number(table.find((line) => line.trim().startsWith("uncorrected")).trim().split(/\s+/)[2])) < 0.03, rms);
    const [name, report] = await saved(page, "#report");
    assert.ok(name === "star.report.html" && report.includes("contour report"), name);
    await page.close();
  },

  async "a corrected program is predicted and downloaded"() {
    const page = await visit(`${address}#example=star`);
    await seen(page, "#figures");
    await page.click("#correct");
    await seen(page, "#corrected");
    const [before, after] = await cells(page, "#corrected");
    assert.ok(Number(after[2]) < 0.5 * Number(before[2]), `${before} ${after}`);
    const [name, program] = await saved(page, "#download");
    assert.ok(name === "star.corrected.ngc" && program.includes("corrected by feedwright"), name);
    await picture(page, "corrected");
    await page.close();
  },

  async "a cut is kept, and another one is compared with it"() {
    const page = await visit(`${address}#example=star`);
    await seen(page, "#figures");
    const [, before] = await cells(page, "#figures");
    await page.click("#shown button >> nth=1");
    await page.click("#keep");
    assert.equal((await cells(page, "#figures")).length, 2);
    await page.selectOption("#machine", "stiff");
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#figures");
    const [, after, kept] = await cells(page, "#figures");
    assert.deepEqual(kept.slice(1), before.slice(1));
    assert.notDeepEqual(after.slice(1), before.slice(1));
    assert.match(kept[0], /before: star\.ngc on workshop$/);
    assert.equal(await page.locator("#key .kept").count(), 1);
    await picture(page, "compared");
    // Its path is drawn, too.
    const drawn = () => page.evaluate(() => document.querySelector("#view canvas").toDataURL());
    await page.evaluate(() => feedwright.view.draw());
    const both = await drawn();
    await page.click("#keep");
    await page.evaluate(() => feedwright.view.draw());
    assert.notEqual(await drawn(), both);
    assert.equal((await cells(page, "#figures")).length, 2);
    await page.close();
  },

  async "a log is identified with the machine file of the command, and its machine is cut on"() {
    const folder = await mkdtemp(join(tmpdir(), "feedwright-")), log = join(folder, "mine.csv"), file = join(folder, "mine.toml");
    execFileSync(command, ["run", star, "--controller", "uncorrected", "--quiet", "--trace", log], { stdio: "ignore" });
    execFileSync(command, ["identify", log, "--out", file], { stdio: "ignore" });
    const page = await visit(address);
    await seen(page, "#cards button");
    await drop(page, "star.ngc", await readFile(star, "utf8"));
    await page.waitForSelector("#run:enabled");
    await drop(page, "mine.csv", await readFile(log, "utf8"));
    await seen(page, "#identified");
    const [name, machine] = await saved(page, "#machine-file");
    assert.deepEqual([name, machine], ["mine.toml", await readFile(file, "utf8")]);
    assert.match((await saved(page, "#identification"))[1], /Identification from mine\.csv/);
    assert.equal(await page.$eval("#machine", ({ selectedOptions }) => selectedOptions[0].text), "mine.toml");
    await picture(page, "identified");
    // A controller with a model takes another identification, of the machine that was found.
    await page.selectOption("#controller", "feedforward");
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#figures");
    // What is no log says so.
    await drop(page, "other.csv", "a,b\n1,2\n");
    await seen(page, "#message");
    assert.match(await page.textContent("#message"), /other\.csv/);
    await page.close();
    await rm(folder, { recursive: true });
  },

  async "the record of the supervisor, the slowest lines and the limits are those of the command"() {
    const folder = await mkdtemp(join(tmpdir(), "feedwright-")), [json, trace, report] = ["json", "csv", "html"].map((ending) => join(folder, `bore.${ending}`));
    const bore = new URL("examples/bore.ngc", import.meta.url).pathname;
    try {
      execFileSync(command, ["run", bore, "--machine", "stiff", "--quiet", "--json", json, "--trace", trace, "--report", report], { stdio: "ignore" });
    } catch (error) {
      // Out of tolerance, or worse than without.
      assert.equal(error.status, 1);
    }
    const page = await visit(`${address}#machine=stiff`);
    await seen(page, "#cards button");
    await drop(page, "bore.ngc", await readFile(bore, "utf8"));
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#figures");
    await page.click("#shown button >> nth=-1");
    const rows = (list) => page.$$eval(`#${list} li`, (items) => items.map((item) => [...item.firstChild.children].map((part) => part.textContent)));
    const { transitions } = JSON.parse(await readFile(json, "utf8")).runs.at(-1), record = await rows("record");
    assert.ok(transitions.length > 0, "a case without a transition shows nothing");
    assert.deepEqual(record.map(([time, line]) => [time, line]), transitions.map(({ at_s, line }) => [`${at_s.toFixed(3)} s`, `line ${line}`]));
    assert.equal(record[0][2], `goes by what it learned of ${transitions[0].axis}`);
    const [columns, ...periods] = (await readFile(trace, "utf8")).trim().split("\n").filter((row) => !row.startsWith("#")).map((row) => row.split(","));
    const [t, of] = ["t_s", "line"].map((column) => columns.indexOf(column)), times = {};
    for (const row of periods) times[row[of]] = (times[row[of]] ?? 0) + (periods[1][t] - periods[0][t]);
    const slowest = await rows("slow");
    assert.equal(slowest.length, 5);
    for (const [time, line, text] of slowest) {
      const takes_s = times[line.replace("line ", "")];
      assert.ok(Math.abs(parseFloat(time) - takes_s) < 0.01 + 0.01 * takes_s, `${line}: ${time}, not ${takes_s}`);
      assert.ok((await readFile(bore, "utf8")).includes(text));
    }
    await page.click("#slow button >> nth=0");
    assert.match(await page.textContent("#readout"), new RegExp(`${slowest[0][1]} `));
    const limits = await rows("limits"), drawn = (await readFile(report, "utf8")).matchAll(/text-anchor="end">([a-z ]+) (\d+) %<\/text>/g);
    const shares = Object.fromEntries([...drawn].map(([, name, part]) => [name, `${part} %`]));
    assert.ok(limits.length > 2, "several limits bind on this part");
    assert.deepEqual(Object.fromEntries(limits.map(([part, , name]) => [name, part])), shares);
    await page.click("#limits button >> nth=0");
    assert.match(await page.textContent("#readout"), new RegExp(`${limits[0][1]} `));
    await picture(page, "record");
    await page.close();
    await rm(folder, { recursive: true });
  },

  async "a model that a log told is kept for the next run and for the next visit"() {
    const machine = 'base = "tnv40"\nname = "mine"\n[axis.x]\nkp_1_s = 48\n', program = "G21 G90 G64 F3000\nG2 X0 Y0 I10 J0\nM2\n";
    const page = await visit(address), times = [], results = [];
    const run = async () => {
      await seen(page, "#cards button");
      await drop(page, "mine.toml", machine);
      await drop(page, "circle.ngc", program);
      await page.waitForSelector("#run:enabled");
      for (const _ of times.length ? [0] : [0, 1]) {
        const begun = performance.now();
        await page.click("#run");
        await page.waitForSelector("#cancel:not([hidden]), #run:disabled");
        await page.waitForSelector("#run:enabled", { timeout: 300_000 });
        times.push(performance.now() - begun);
        results.push(await page.textContent("#figures"));
      }
    };
    await run();
    await page.reload();
    await run();
    const [first, second, third] = times;
    assert.ok(second < first / 3 && third < first / 3, `${times}`);
    assert.ok(results.every((result) => result === results[0]) && results[0], `${results}`);
    await page.close();
  },

  async "six questions make a machine that lags as it was told, in millimetres and in inches"() {
    const folder = await mkdtemp(join(tmpdir(), "feedwright-")), file = join(folder, "mine.toml"), trace = join(folder, "line.csv"), line = join(folder, "line.ngc");
    await writeFile(line, "G21 G90 F6000\nG1 X60 Y60\nM2\n");
    const page = await visit(address);
    await seen(page, "#cards button");
    await drop(page, "star.ngc", await readFile(star, "utf8"));
    await page.focus("#describe");
    await page.keyboard.press("Enter");
    await page.fill("[name=feed]", "0");
    await page.click("#questions .primary");
    assert.ok(await page.isVisible("#questions"), "a feed of 0 is no machine");
    const answers = { feed: 6000, rapid: 8000, accel: 800, lead: 5, lag: 0.5, servo: 1 };
    for (const [name, value] of Object.entries(answers)) await page.fill(`[name=${name}]`, String(value));
    await picture(page, "questions");
    const [name, text] = await saved(page, "#described");
    assert.equal(name, "mine.toml");
    await page.keyboard.press("Escape");
    await seen(page, "#describe");
    await writeFile(file, text);
    const report = join(folder, "line.html");
    execFileSync(command, ["run", line, "--machine", file, "--controller", "uncorrected", "--quiet", "--trace", trace, "--report", report], { stdio: "ignore" });
    const rows = (await readFile(trace, "utf8")).trim().split("\n").filter((row) => !row.startsWith("#")).map((row) => row.split(","));
    const [cmd, act] = ["cmd_x_mm", "act_x_mm"].map((column) => rows[0].indexOf(column)), middle = Math.floor(rows.length / 2);
    // Along the diagonal, each axis has 1 / sqrt 2 of the feed and of the lag. A row has the command at its beginning, and the tool at its end.
    const lag_mm = Math.SQRT2 * (rows[middle][cmd] - rows[middle - 1][act]);
    assert.ok(Math.abs(lag_mm / answers.lag - 1) < 0.02, `${lag_mm}`);
    // In inches the same machine.
    await page.click("[data-units=in]");
    await page.click("#describe");
    for (const [name, value] of Object.entries(answers)) await page.fill(`[name=${name}]`, String(name === "servo" ? value : value / 25.4));
    assert.equal((await saved(page, "#described"))[1], text);
    await page.click("#questions .primary");
    assert.equal(await page.$eval("#machine", ({ selectedOptions }) => selectedOptions[0].text), "mine.toml");
    await page.waitForSelector("#run:enabled");
    assert.ok(await page.isHidden("#message"), await page.textContent("#message"));
    await page.close();
    await rm(folder, { recursive: true });
  },

  async "a mistake is told while it is typed, and a corrected line is cut"() {
    // The first text comes while the engine starts.
    const later = () => { let resolve; const promise = new Promise((r) => (resolve = r)); return { promise, resolve }; };
    const [asked, typed] = [later(), later()];
    const page = await visit(address, {}, (page) => page.route("**/engine.js", async (route) => {
      asked.resolve();
      await typed.promise;
      await route.continue();
    }));
    await asked.promise;
    await page.fill("#text", "G21 G90 F600\nG1 X10\nG1 X20 Q\nM2\n");
    await page.waitForTimeout(500);
    typed.resolve();
    await seen(page, "#findings .error");
    assert.match(await page.textContent("#findings"), /^3:\d+ error/);
    assert.ok(await page.isDisabled("#run"));
    await picture(page, "mistake");
    await page.fill("#text", "G21 G90 F600\nG1 X10\nG1 X20\nM2\n");
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#figures");
    // What is changed has no results.
    await page.fill("#text", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForSelector("#figures", { state: "hidden" });
    await page.close();
  },

  async "files are dropped, the program and the machine"() {
    const page = await visit(address);
    await seen(page, "#cards button");
    await drop(page, "part.nc", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForSelector("#run:enabled");
    assert.equal(await page.textContent("#name"), "part.nc");
    await drop(page, "mine.toml", "name = 1\n");
    await seen(page, "#message");
    assert.match(await page.textContent("#message"), /mine\.toml/);
    await page.close();
  },

  async "a cut is cancelled"() {
    const page = await visit(address);
    const lines = Array.from({ length: 4000 }, (_, k) => `G1 X${k % 2 ? 50 : 0} Y${k / 100}`);
    // A drop: in a text area, a browser types 4000 lines for minutes.
    await seen(page, "#cards button");
    await drop(page, "long.nc", `G21 G90 F6000\n${lines.join("\n")}\nM2\n`);
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#work");
    await page.waitForFunction(() => document.querySelector("#bar").value > 0);
    await page.click("#cancel");
    await page.waitForSelector("#work", { state: "hidden" });
    assert.ok(await page.isHidden("#figures"));
    assert.ok(await page.isEnabled("#run"));
    await page.close();
  },

  async "after the first visit the page works without its server, and takes a new version whole"() {
    const server = await host(), context = await browser.newContext(), page = await context.newPage();
    page.on("pageerror", (error) => faults.push(error.message));
    await page.goto(server.address);
    await seen(page, "#cards button");
    await page.evaluate(() => navigator.serviceWorker.ready);
    await server.end();
    await page.reload();
    await page.click("[data-example=star]");
    await seen(page, "#figures");
    // The server comes back with another version. As long as a page of the old one is open, that is what there is.
    const folder = await mkdtemp(join(tmpdir(), "feedwright-"));
    await cp(DIST, folder, { recursive: true });
    await writeFile(join(folder, "index.html"), (await readFile(join(DIST, "index.html"), "utf8")).replace("</h1>", " II</h1>"));
    const build = new URL("offline.mjs", import.meta.url).pathname;
    await writeFile(join(folder, "offline.js"), execFileSync(process.execPath, [build, folder]));
    const newer = await host({ folder, port: server.port });
    await page.evaluate(async () => {
      const registration = await navigator.serviceWorker.ready;
      await registration.update();
      while (!registration.waiting) await new Promise((later) => setTimeout(later, 50));
    });
    await page.reload();
    assert.equal(await page.textContent("h1"), "feedwright");
    await page.close();
    const next = await context.newPage();
    for (let visit = 0; (await next.goto(server.address), await next.textContent("h1")) !== "feedwright II"; visit++) {
      assert.ok(visit < 50, "the new version does not come");
      // The browser takes it once the old one is at rest, and each visit keeps that busy.
      await next.goto("about:blank");
      await next.waitForTimeout(1000);
    }
    // Of the page and of the models that one engine came to there is one each.
    const names = await next.evaluate(() => caches.keys()), ofModels = names.filter((name) => name.startsWith("feedwright models "));
    assert.ok(names.length - ofModels.length === 1 && ofModels.length <= 1, names.join());
    await context.close();
    await newer.end();
    await rm(folder, { recursive: true });
  },

  async "files of two versions are not kept, and a full disk is no fault"() {
    const longer = (name, bytes) => name === "app.css" ? Buffer.concat([bytes, Buffer.from(" ")]) : bytes;
    for (const [change, quota] of [[longer, undefined], [undefined, 100_000]]) {
      const server = await host({ change }), context = await browser.newContext(), page = await context.newPage();
      page.on("pageerror", (error) => faults.push(error.message));
      const storage = await context.newCDPSession(page);
      if (quota) await storage.send("Storage.overrideQuotaForOrigin", { origin: new URL(server.address).origin, quotaSize: quota });
      await page.goto(server.address);
      await seen(page, "#cards button");
      const end = await page.evaluate(async () => {
        const { installing, waiting, active } = await navigator.serviceWorker.register("offline.js"), worker = installing ?? waiting ?? active;
        while (!["activated", "redundant"].includes(worker.state)) await new Promise((changed) => worker.addEventListener("statechange", changed, { once: true }));
        return worker.state;
      });
      assert.equal(end, "redundant");
      await page.click("[data-example=star]");
      await seen(page, "#figures");
      await context.close();
      await server.end();
    }
  },

  async "a file that no browser can hold is refused"() {
    const page = await visit(address);
    await seen(page, "#cards button");
    await page.evaluate(() => {
      const data = new DataTransfer(), chunk = new Blob(["G1 X1\n".repeat(2 ** 20)]);
      data.items.add(new File(Array(160).fill(chunk), "huge.ngc"));
      dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
    });
    await seen(page, "#message");
    assert.match(await page.textContent("#message"), /huge\.ngc.*1010 MB.*537 MB/);
    await drop(page, "part.nc", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForSelector("#run:enabled");
    assert.ok(await page.isHidden("#message"));
    await page.close();
  },

  async "a long program is shown in parts, with the numbers of its lines"() {
    const page = await visit(address), lines = Array.from({ length: 150_000 }, (_, k) => `G1 X${k % 2}.0000 Y${k % 7}`);
    lines[99_999] = "G1 X1 Q";
    await seen(page, "#cards button");
    await drop(page, "long.ngc", `G21 G90 F6000\n${lines.join("\n")}\nM2\n`);
    await page.click("#findings button");
    const shown = () => page.$eval("#text", ({ value, selectionStart, readOnly }) =>
      ({ lines: value.split("\n").length, before: value.slice(0, selectionStart), readOnly }));
    const { lines: count, before, readOnly } = await shown();
    assert.ok(readOnly && count <= 4001 && before.endsWith("\nG1 X1 Q"), `${count} ${before.slice(-20)}`);
    assert.equal(await page.textContent("#gutter .error"), "100001");
    // At the end of the part, the next one follows.
    const last = () => page.$eval("#gutter", (gutter) => Number(gutter.lastChild.textContent));
    for (let k = 0; k < 3; k++) {
      const before = await last();
      await page.$eval("#text", (text) => (text.scrollTop = text.scrollHeight));
      await page.waitForFunction((before) => Number(document.querySelector("#gutter").lastChild.textContent) > before, before);
    }
    assert.ok((await last()) > 103_000, String(await last()));
    await drop(page, "part.nc", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForSelector("#run:enabled");
    assert.equal(await page.inputValue("#text"), "G21 G90 F600\nG1 X10\nM2\n");
    assert.ok(!(await shown()).readOnly);
    await page.close();
  },

  async "a long program that changes on the disk is to be opened again"() {
    const page = await visit(address), folder = await mkdtemp(join(tmpdir(), "feedwright-")), file = join(folder, "long.ngc");
    const program = `G21 G90 F6000\n${"G1 X1.0000 Y2.0000\nG1 X0.0000 Y0.0000\n".repeat(60_000)}M2\n`;
    await writeFile(file, program);
    await seen(page, "#cards button");
    await page.setInputFiles("#file", file);
    await page.waitForSelector("#run:enabled");
    await writeFile(file, `${program}\n`);
    await page.click("#run");
    await seen(page, "#message");
    assert.equal(await page.textContent("#message"), "long.ngc was changed or moved since it was opened. Open it again");
    await page.close();
    await rm(folder, { recursive: true });
  },

  async "a program that never ends is given up by Esc, or by another one"() {
    const page = await visit(address), endless = "G21 G90 F600\no1 while [1]\nG1 X1\nG1 X0\no1 endwhile\nM2\n";
    await seen(page, "#cards button");
    const reading = () => page.waitForFunction(() => document.querySelector("#amounts").textContent.startsWith("Reading"));
    await drop(page, "endless.ngc", endless);
    await reading();
    await page.keyboard.press("Escape");
    await page.waitForFunction(() => document.querySelector("#amounts").textContent === "");
    assert.ok(await page.isDisabled("#run"));
    await drop(page, "endless.ngc", endless);
    await reading();
    await drop(page, "part.nc", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForSelector("#run:enabled");
    await page.close();
  },

  async "markup and control characters stay text, on the page and in the report"() {
    const page = await visit(address), markup = "<img src=x onerror=document.title='taken'><script>document.title='taken'</script>";
    await seen(page, "#cards button");
    await drop(page, `${markup}.ngc`, `(${markup})\nG21 G90 F600\nG1 X10 (${markup})\nG1 X10 Y10\nM2\n`);
    await page.waitForFunction(() => document.querySelector("#name").textContent.includes("<img"));
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#figures");
    assert.equal(await page.locator("main img, main script").count(), 0);
    assert.match(await page.title(), /^<img.* · feedwright$/);
    const [, report] = await saved(page, "#report");
    await drop(page, `\u202e${markup}.ngc`, `(\u0007 \u202e ${markup})\nG1 ${markup}\n`);
    await seen(page, "#findings .error");
    assert.doesNotMatch(await page.textContent("#findings"), /[\u0007\u202e]/);
    assert.equal(await page.locator("main img, main script").count(), 0);
    await drop(page, "binary.ngc", `G1 X1 F100 ${markup}\u0000\n`);
    await seen(page, "#message");
    assert.equal(await page.locator("main img, main script").count(), 0);
    // The report is a file of its own, with a policy of its own.
    const opened = await browser.newPage();
    opened.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    opened.on("pageerror", (error) => faults.push(error.message));
    await opened.route("**/report.html", (route) => route.fulfill({ body: report, contentType: "text/html" }));
    await opened.goto("http://127.0.0.1/report.html");
    await opened.waitForFunction(() => document.documentElement.dataset.ready !== undefined);
    assert.doesNotMatch(await opened.title(), /^taken/);
    assert.equal(await opened.locator("img[src=x]").count(), 0);
    await opened.close();
    await page.close();
  },

  async "an engine that does not arrive whole is told"() {
    for (const [name, answer] of Object.entries({
      cut: async (route) => route.fulfill({ body: (await readFile(join(DIST, "engine.wasm.gz"))).subarray(0, 500_000) }),
      missing: (route) => route.fulfill({ status: 404 }),
      other: (route) => route.fulfill({ body: "<html>" }),
      empty: (route) => route.fulfill({ body: "" }),
    })) {
      const page = await visit(address, {}, (page) => page.route("**/engine.wasm.gz", answer));
      await seen(page, "#message");
      assert.match(await page.textContent("#message"), /^The engine does not start: .+ Load the page again\.$/, name);
      assert.ok(await page.isDisabled("#run"));
      await page.close();
      // The browser reports the 404 itself.
      if (name === "missing") faults.splice(0);
    }
  },

  async "a page that is closed in mid-run leaves the others alone"() {
    const [page, other] = [await visit(address), await visit(address)];
    for (const one of [page, other]) await seen(one, "#cards button");
    await page.click("[data-example=pocket]");
    await page.waitForFunction(() => document.querySelector("#bar").value > 0);
    await page.close();
    await other.click("[data-example=star]");
    await seen(other, "#figures");
    await other.close();
  },

  async "the file of the command line is there"() {
    const page = await visit(withFile);
    await page.waitForSelector("#run:enabled");
    assert.equal(await page.textContent("#name"), "star.ngc");
    assert.equal(await page.inputValue("#text"), await readFile(star, "utf8"));
    await page.close();
  },

  async "a part beside the page is opened by its address"() {
    const folder = await mkdtemp(join(tmpdir(), "feedwright-"));
    await cp(DIST, folder, { recursive: true });
    await mkdir(join(folder, "parts"));
    await cp(new URL("../../parts/eight.ngc", import.meta.url).pathname, join(folder, "parts/eight.ngc"));
    const server = await host({ folder }), page = await visit(`${server.address}#part=eight.ngc&machine=stiff`);
    await seen(page, "#figures");
    assert.deepEqual([await page.textContent("#name"), await page.inputValue("#machine")], ["eight.ngc", "stiff"]);
    assert.match(page.url(), /#part=eight\.ngc&machine=stiff$/);
    // What is changed is no longer that part.
    await page.fill("#text", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForURL(/#machine=stiff$/);
    await page.close();
    const other = await visit(`${server.address}#part=none.ngc`);
    await seen(other, "#message");
    assert.equal(await other.textContent("#message"), "parts/none.ngc is not there.");
    // The browser reports the 404 itself.
    faults.splice(0);
    await other.close();
    await server.end();
    await rm(folder, { recursive: true });
  },

  async "the machine of LinuxCNC is shown with its path and its errors, and a cut beside it"() {
    const folder = await mkdtemp(join(tmpdir(), "feedwright-")), began = Date.now();
    // In place of LinuxCNC's program: shows the pins of a file, and keeps what it was asked.
    const halcmd = 'while read -r command; do echo "$command" >> "$PINS/asked"; grep -F "${command##* }" "$PINS/pins"; echo; done';
    await writeFile(join(folder, "halcmd"), `#!/bin/sh\n${halcmd}\n`, { mode: 0o755 });
    await writeFile(join(folder, "pins"), "");
    const { child, address } = open(["--hal"], { PATH: `${folder}:${process.env.PATH}`, PINS: folder });
    const page = await visit(await address), state = (text) => page.waitForFunction((text) => document.querySelector("#live-state").textContent.startsWith(text), text);
    await state("LinuxCNC does not run on this computer.");
    // A circle of 10 mm in four seconds.
    const turn = async () => {
      const angle = (Date.now() - began) / 640, pins = {
        "actual-0": 10 * Math.cos(angle), "actual-1": 10 * Math.sin(angle), "contour-error": 0.0003, "contour-error-without": 0.0123, "correction-0": 0.04,
        "deviation-limit": 0.5, enable: "TRUE", fault: "FALSE", cause: 0, state: 4,
      };
      await writeFile(join(folder, "new"), Object.entries(pins).map(([name, value]) => `feedwright float OUT ${value} feedwright.${name}\n`).join(""));
      await rename(join(folder, "new"), join(folder, "pins"));
    };
    let turning = true;
    const turns = (async () => { for (; turning; await new Promise((later) => setTimeout(later, 20))) await turn(); })();
    await state("Correcting");
    await page.waitForFunction(() => document.querySelector("#live-figures tbody td"));
    assert.deepEqual(await cells(page, "#live-figures"), [["without correction", "12.30", "12.30"], ["measured", "0.30", "0.30"]]);
    assert.equal(await page.textContent("#live-correction"), "Correction X 40.00  Y 0.00  Z 0.00 of 500.00 µm");
    assert.equal(await page.textContent("#largest"), "0.30 µm");
    // The tool moves, and leaves its path behind.
    const drawn = () => page.$$eval("#view canvas", (canvases) => canvases.map((canvas) => canvas.toDataURL()));
    const before = await drawn();
    await page.waitForTimeout(1500);
    (await drawn()).forEach((picture, k) => assert.notEqual(picture, before[k], `canvas ${k}`));
    await page.waitForTimeout(process.env.SCREENSHOTS ? 3000 : 0);
    await picture(page, "live");
    await page.click("[data-units=in]");
    await page.waitForFunction(() => document.querySelector("#live-figures tbody td").textContent === "0.484");
    await page.click("[data-units=mm]");
    // A simulated cut takes the drawing, until the machine is wanted again.
    await drop(page, "part.nc", "G21 G90 F600\nG1 X10\nM2\n");
    await page.waitForSelector("#run:enabled");
    await page.click("#run");
    await seen(page, "#figures");
    await page.click("#live-show");
    await page.waitForSelector("#figures", { state: "hidden" });
    await page.waitForFunction(() => document.querySelector("#largest").textContent === "0.30 µm");
    await page.setViewportSize({ width: 390, height: 844 });
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
    await picture(page, "live-phone");
    turning = false;
    await turns;
    await page.close();
    child.kill();
    const asked = new Set((await readFile(join(folder, "asked"), "utf8")).trim().split("\n"));
    assert.deepEqual([...asked].sort(), ["show pin feedwright.", "show pin motion."]);
    await rm(folder, { recursive: true });
  },

  async "everything can be done by keyboard"() {
    const page = await visit(address);
    await seen(page, "#cards button");
    const focus = () => page.evaluate(() => document.activeElement?.dataset.example ?? document.activeElement?.id);
    for (let tab = 0; (await focus()) !== "star"; tab++) {
      assert.ok(tab < 40, "the examples cannot be reached");
      await page.keyboard.press("Tab");
    }
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle), "none");
    await page.keyboard.press("Enter");
    await seen(page, "#figures");
    await page.focus("#view > canvas:last-of-type");
    for (const key of ["ArrowLeft", "+", "-", "0"]) await page.keyboard.press(key);
    await page.focus("#time");
    await page.keyboard.press("End");
    assert.match(await page.textContent("#readout"), /^\d/);
    await page.focus("#text");
    await page.keyboard.press("Control+Enter");
    await seen(page, "#work");
    await page.keyboard.press("Escape");
    await page.waitForSelector("#work", { state: "hidden" });
    await page.close();
  },

  async "colors have the contrast of WCAG AA, light and dark, and nothing moves for those who want that"() {
    for (const colorScheme of ["light", "dark"]) {
      const page = await visit(address, { colorScheme, reducedMotion: "reduce" });
      const ratios = await page.evaluate(() => {
        const probe = document.body.appendChild(document.createElement("i"));
        const g = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d", { willReadFrequently: true });
        const luminance = (name) => {
          probe.style.setProperty("color", `var(${name})`);
          g.fillStyle = getComputedStyle(probe).color;
          g.fillRect(0, 0, 1, 1);
          const [r, green, b] = [...g.getImageData(0, 0, 1, 1).data].map((v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
          return 0.2126 * r + 0.7152 * green + 0.0722 * b;
        };
        const pairs = ["--ink", "--ink-2", "--ink-3", "--alarm"].flatMap((ink) => ["--bg", "--panel", "--hover"].map((ground) => [ink, ground]));
        return [...pairs, ["--on-accent", "--accent"], ["--on-accent", "--alarm"]].map(([ink, ground]) => {
          const [low, high] = [luminance(ink), luminance(ground)].sort((a, b) => a - b);
          return [`${ink} on ${ground}`, (high + 0.05) / (low + 0.05)];
        });
      });
      for (const [pair, ratio] of ratios) assert.ok(ratio >= 4.5, `${colorScheme}, ${pair}: ${ratio.toFixed(2)}`);
      assert.match(await page.$eval("#open", (button) => getComputedStyle(button).transitionDuration), /^0s$/);
      await seen(page, "#cards button");
      await picture(page, colorScheme);
      await page.close();
    }
  },

  async "on a phone nothing is wider than the screen"() {
    const page = await visit(`${address}#example=star`, { viewport: { width: 390, height: 844 }, hasTouch: true });
    await seen(page, "#figures");
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
    await picture(page, "phone");
    await page.close();
  },
};

try {
  for (const [name, test] of Object.entries(tests).filter(([name]) => name.includes(part))) {
    const began = Date.now();
    await test();
    assert.deepEqual(faults, [], name);
    console.log(`page: ${name} (${((Date.now() - began) / 1000).toFixed(1)} s)`);
  }
} finally {
  await browser.close();
  served.forEach(({ child }) => child.kill());
}
