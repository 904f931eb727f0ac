// Pages of tables and figures: light and dark, parts that fold, tables that are sorted by a click on a heading.

const root = document.documentElement;
root.classList.add("js");
const $ = (selector) => [...document.querySelectorAll(selector)];

function setUpTheme() {
  const [button] = $("#theme"), names = ["auto", "light", "dark"];
  const apply = (name) => {
    if (name === "auto") delete root.dataset.theme; else root.dataset.theme = name;
    button.textContent = `Theme: ${name}`;
  };
  button.addEventListener("click", () => apply(names[(names.indexOf(root.dataset.theme || "auto") + 1) % names.length]));
}

function setUpParts() {
  const parts = $("details.part");
  const fold = (open) => () => parts.forEach((part) => { part.open = open; });
  $("#unfold")[0].addEventListener("click", fold(true));
  $("#fold")[0].addEventListener("click", fold(false));
  // What a link leads to is there to be seen.
  const show = () => {
    const part = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!part) return;
    if (part.localName === "details") part.open = true;
    part.scrollIntoView();
  };
  addEventListener("hashchange", show);
  const [contents] = $(".contents > details");
  if (innerWidth < 1100) contents.open = false;
  contents.addEventListener("click", (event) => {
    if (innerWidth < 1100 && event.target.localName === "a") contents.open = false;
  });
  addEventListener("beforeprint", () => $("details").forEach((each) => { each.open = true; }));
  show();
}

// The number that a cell begins with, or its text. Cells without either come last.
function sortKey(cell) {
  const text = cell ? cell.textContent.trim().replace(/\u2212/g, "-") : "", number = parseFloat(text);
  return Number.isFinite(number) ? { number } : { text };
}

function compareKeys(a, b) {
  if (a.number !== undefined && b.number !== undefined) return a.number - b.number;
  if (a.number !== undefined) return -1;
  if (b.number !== undefined) return 1;
  return (a.text === "") - (b.text === "") || a.text.localeCompare(b.text);
}

// A click sorts upwards, the next downwards, the third as it was.
function setUpSorting(table) {
  const [body] = table.tBodies, rows = [...body.rows], heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    if (!head.textContent.trim() || rows.length < 2) return;
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const next = { ascending: "descending", descending: null }[head.getAttribute("aria-sort")];
      const order = next === undefined ? "ascending" : next;
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      const sorted = [...rows];
      if (order) {
        head.setAttribute("aria-sort", order);
        const sign = order === "ascending" ? 1 : -1;
        sorted.sort((a, b) => {
          const keys = [a, b].map((row) => sortKey(row.cells[column]));
          const missing = keys.some((key) => key.number === undefined) && keys.some((key) => key.number !== undefined);
          return compareKeys(...keys) * (missing ? 1 : sign);
        });
      }
      body.append(...sorted);
    });
  });
}

setUpTheme();
setUpParts();
$("table").forEach(setUpSorting);
root.dataset.ready = "";
