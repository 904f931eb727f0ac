// Colors as they are now, light or dark; the scale of errors is that of the report.

const probe = document.createElement("span");
probe.hidden = true;
document.body.append(probe);

/** Color of a custom property: getPropertyValue would not resolve light-dark(). */
export function color(name: string): string {
  probe.style.color = `var(${name})`;
  return getComputedStyle(probe).color;
}

export const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches;

/** Steps of the scale. */
export const STEPS = 24;

// From no error to the largest. The lightness leaves that of the background evenly: the scale reads in grey, too.
const ON_LIGHT = [[104, 148, 205], [127, 143, 208], [138, 104, 186], [141, 63, 159], [124, 18, 119], [62, 0, 66]];
const ON_DARK = [[74, 110, 184], [44, 128, 160], [38, 158, 140], [74, 190, 110], [160, 218, 57], [253, 231, 37]];

/** Color of an error as a part of the largest. */
export function errorColor(part: number): string {
  const map = isDark() ? ON_DARK : ON_LIGHT, place = Math.min(1, Math.max(0, part)) * (map.length - 1);
  const i = Math.min(map.length - 2, Math.floor(place)), w = place - i;
  return `rgb(${map[i].map((c, k) => Math.round(c + w * (map[i + 1][k] - c))).join(",")})`;
}
