// Light and dark, and the colours that canvases need.

const root = document.documentElement;
const probe = document.createElement("span");
probe.hidden = true;
document.body.append(probe);

// Colour of a custom property as it is now; getPropertyValue would not resolve light-dark().
function color(name) {
  probe.style.color = `var(${name})`;
  return getComputedStyle(probe).color;
}

const runColor = (i) => color(`--run-${i % 6}`);

function isDark() {
  const chosen = root.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

// Viridis, whose lightness rises evenly, so that it also reads in grey and with colour blindness.
const VIRIDIS = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37],
];

// Small errors stand near to the background, large ones far from it.
function errorColor(fraction) {
  const f = Math.min(1, Math.max(0, fraction));
  const place = (isDark() ? 0.22 + 0.78 * f : 0.86 * (1 - f)) * (VIRIDIS.length - 1);
  const i = Math.min(VIRIDIS.length - 2, Math.floor(place)), w = place - i;
  const mix = VIRIDIS[i].map((c, k) => Math.round(c + w * (VIRIDIS[i + 1][k] - c)));
  return `rgb(${mix.join(",")})`;
}

function setUpTheme(button, changed) {
  const names = ["auto", "light", "dark"];
  const apply = (name) => {
    if (name === "auto") delete root.dataset.theme; else root.dataset.theme = name;
    button.textContent = `Theme: ${name}`;
    changed();
  };
  button.addEventListener("click", () => {
    apply(names[(names.indexOf(root.dataset.theme || "auto") + 1) % names.length]);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  let before = "auto";
  addEventListener("beforeprint", () => {
    before = root.dataset.theme || "auto";
    apply("light");
    for (const fold of document.querySelectorAll("details.notes")) fold.open = true;
  });
  addEventListener("afterprint", () => apply(before));
  return apply;
}
