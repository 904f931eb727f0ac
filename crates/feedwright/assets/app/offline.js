const VERSION = "bbf0b9d03b15d549", FILES = {
 "./": "sha256-Qs4ATTAQOK96Cxh1kcxTFGVGCjquH4Zw5AoGVUgo5PE=",
 "app.css": "sha256-1M8CTdqQ4GSD7BJH8vqN2bnstEVWNjaRtXiVaFv7EKc=",
 "app.js": "sha256-tXzJjEfURM5Cf6r+VApujGQqOg22/BR8FaPKGxTayyk=",
 "engine.js": "sha256-2aC9DkFfRCPTBX11G0SQrK38iVMPSIQMMfpDRD53VJI=",
 "engine.wasm.gz": "sha256-rPTjtNx/oTzOtddOgedhgANAPKnpGuve9Z06BR29uM4=",
 "files.json": "sha256-OOC53oF/ZFxL7DfA1KPli67MywQPVxjcBppyxzhaC+0="
};
// Keeps the page for visits without its server. FILES has the hash of each file, VERSION that of all: web/app/offline.mjs puts both before
// this text. A new version waits until no page of the old one is open: no page gets files of both.
const PREFIX = `feedwright ${registration.scope} `, NAME = PREFIX + VERSION;

addEventListener("install", (event) => event.waitUntil(keep()));
addEventListener("activate", (event) => event.waitUntil(dropOthers()));
addEventListener("fetch", (event) => {
  const { method, url } = event.request;
  if (method === "GET" && url.startsWith(registration.scope)) event.respondWith(answer(event.request));
});

/** All files or none: one with another hash is of another version, or broken on its way. */
async function keep() {
  const cache = await caches.open(NAME);
  await cache.addAll(Object.entries(FILES).map(([name, integrity]) => new Request(name, { integrity, cache: "no-cache" })));
}

async function dropOthers() {
  const others = (await caches.keys()).filter((name) => name.startsWith(PREFIX) && name !== NAME);
  await Promise.all(others.map((name) => caches.delete(name)));
}

async function answer(request) {
  const cache = await caches.open(NAME), name = request.url.replace(/index\.html(?=[?#]|$)/, "");
  return (await cache.match(name, { ignoreSearch: true })) ?? fetch(request);
}
