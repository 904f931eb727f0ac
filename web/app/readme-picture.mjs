// The picture of README.md, light and dark: the headline of a report, and the part colored by its error. `just readme-picture` makes it.
//   node readme-picture.mjs REPORT.html FOLDER
import { writeFile } from "node:fs/promises";
import { resolve } from "node:path";
import { crc32, deflateSync } from "node:zlib";
import { chromium } from "playwright-core";

const [report, folder] = process.argv.slice(2);
/** Size of the page in CSS pixels: both parts stand side by side, and the text is read at the width of a README. */
const VIEWPORT = { width: 720, height: 560 };
/** Largest size of a file, bytes. */
const MOST_BYTES = 150_000;
const COLORS = 256;

/** PNG with a palette: the most frequent colors; every other pixel gets the nearest of them. */
function png({ width, height, pixels }) {
  const color = (i) => (pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2];
  const counts = new Map();
  for (let i = 0; i < pixels.length; i += 4) counts.set(color(i), (counts.get(color(i)) ?? 0) + 1);
  const palette = [...counts].sort((a, b) => b[1] - a[1]).slice(0, COLORS).map(([color]) => color);
  const channels = (color) => [color >> 16, (color >> 8) & 255, color & 255];
  const nearest = new Map(palette.map((color, index) => [color, index]));
  const index = (color) => {
    if (!nearest.has(color)) {
      const distance = (other) => channels(other).reduce((sum, value, k) => sum + (value - channels(color)[k]) ** 2, 0);
      nearest.set(color, palette.reduce((best, other, k) => (distance(other) < distance(palette[best]) ? k : best), 0));
    }
    return nearest.get(color);
  };
  const rows = Buffer.alloc((width + 1) * height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) rows[y * (width + 1) + 1 + x] = index(color(4 * (y * width + x)));
  }
  const number = (value) => Buffer.from([value >>> 24, value >>> 16, value >>> 8, value].map((byte) => byte & 255));
  const chunk = (kind, data) => {
    const body = Buffer.concat([Buffer.from(kind), data]);
    return Buffer.concat([number(data.length), body, number(crc32(body))]);
  };
  return Buffer.concat([
    Buffer.from("\x89PNG\r\n\x1a\n", "latin1"),
    chunk("IHDR", Buffer.concat([number(width), number(height), Buffer.from([8, 3, 0, 0, 0])])),
    chunk("PLTE", Buffer.from(palette.flatMap(channels))),
    chunk("IDAT", deflateSync(rows, { level: 9 })),
    chunk("IEND", Buffer.alloc(0)),
  ]);
}

/** The pixels of a picture, as the browser decodes it. */
async function decoded(browser, picture) {
  const page = await browser.newPage();
  const found = await page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const pixels = context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    let text = "";
    for (let i = 0; i < pixels.length; i += 8192) text += String.fromCharCode(...pixels.subarray(i, i + 8192));
    return { width: bitmap.width, height: bitmap.height, pixels: btoa(text) };
  }, picture.toString("base64"));
  await page.close();
  return { ...found, pixels: Buffer.from(found.pixels, "base64") };
}

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
for (const colorScheme of ["light", "dark"]) {
  const page = await browser.newPage({ viewport: VIEWPORT, deviceScaleFactor: 2, colorScheme, bypassCSP: true });
  await page.goto(`file://${resolve(report)}`);
  // Both at the same enlargement, so that the eye compares them. A picture has nothing to click.
  await page.click("#scale button:has-text('common')");
  await page.addStyleTag({ content: ".controls { display: none !important }" });
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  const [top, bottom] = await page.evaluate(() => [
    document.querySelector("h1").getBoundingClientRect().top + scrollY,
    document.querySelector("#views").getBoundingClientRect().bottom + scrollY,
  ]);
  const clip = { x: 0, y: top - 8, width: VIEWPORT.width, height: bottom - top + 16 };
  const picture = png(await decoded(browser, await page.screenshot({ clip, fullPage: true })));
  const path = `${folder}/report_${colorScheme}.png`;
  if (picture.length > MOST_BYTES) throw new Error(`${path} would have ${picture.length} bytes, at most ${MOST_BYTES} are allowed`);
  await writeFile(path, picture);
  console.log(`${path}: ${picture.length} bytes`);
}
await browser.close();
