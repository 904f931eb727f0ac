// Light and dark, and the colours that canvases need.

const root = document.documentElement;
const probe = document.createElement("span");
probe.hidden = true;
document.body.append(probe);

// Colour of a custom property as it is now; getPropertyValue would not resolve light-dark().
export function color(name) {
  probe.style.color = `var(${name})`;
  return getComputedStyle(probe).color;
}

const runColor = (i) => color(`--run-${i % 6}`);

export function isDark() {
  const chosen = root.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

// Colours from no error to the largest. Their lightness leaves that of the background evenly, so that the scale also
// reads in grey and with colour blindness: blue to dark purple on light, blue through green to yellow on dark.
const ON_LIGHT = [[104, 148, 205], [127, 143, 208], [138, 104, 186], [141, 63, 159], [124, 18, 119], [62, 0, 66]];
const ON_DARK = [[74, 110, 184], [44, 128, 160], [38, 158, 140], [74, 190, 110], [160, 218, 57], [253, 231, 37]];

export function errorColor(fraction) {
  const f = Math.min(1, Math.max(0, fraction));
  const map = isDark() ? ON_DARK : ON_LIGHT, place = f * (map.length - 1);
  const i = Math.min(map.length - 2, Math.floor(place)), w = place - i;
  const mix = map[i].map((c, k) => Math.round(c + w * (map[i + 1][k] - c)));
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
