// Prints the service worker of a built page: node offline.mjs FOLDER
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join } from "node:path";

const [folder] = process.argv.slice(2);
const hash = (bytes, form) => createHash("sha256").update(bytes).digest(form);
const named = ["index.html", "app.css", "app.js", "engine.js", "engine.wasm.gz", "files.json"].map((name) =>
  [name === "index.html" ? "./" : name, `sha256-${hash(readFileSync(join(folder, name)), "base64")}`]);
const files = JSON.stringify(Object.fromEntries(named), null, 1);
const text = readFileSync(new URL("src/offline.js", import.meta.url), "utf8");
process.stdout.write(`const VERSION = "${hash(files + text, "hex").slice(0, 16)}", FILES = ${files};\n${text}`);
