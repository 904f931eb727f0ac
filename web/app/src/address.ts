// The address keeps what was chosen: an example, or a part that stands beside the page, and the lists and units.

import { $ } from "./dom";
import type { Lists } from "./messages";
import { type Units, getUnits } from "./units";

/** Lists to choose from: each has its default in `lists` under the same name. */
const CHOICES = ["machine", "controller", "control"] as const;
/** The machine is a file, which the address cannot keep. */
export const FROM_FILE = "file";

const select = (name: string) => $<HTMLSelectElement>(name);

export function keepInUrl(lists: Lists, part: string): void {
  const chosen = new URLSearchParams(), example = select("example").value;
  if (example) chosen.set("example", example);
  else if (part) chosen.set("part", part);
  for (const name of CHOICES) {
    const { value } = select(name);
    if (value !== lists[name] && value !== FROM_FILE) chosen.set(name, value);
  }
  if (getUnits() !== "mm") chosen.set("units", getUnits());
  history.replaceState(null, "", chosen.size ? `#${chosen}` : location.pathname);
}

/** Chooses what the address says. Returns the example, the part in the folder `parts`, and the units. */
export function takeFromUrl(): { example: string; part: string; units: Units } {
  const chosen = new URLSearchParams(location.hash.slice(1)), part = chosen.get("part") ?? "";
  for (const name of CHOICES) {
    const value = chosen.get(name), list = select(name);
    if (value && [...list.options].some((option) => option.value === value)) list.value = value;
  }
  return {
    example: chosen.get("example") ?? "",
    part: /^\w[\w.-]*$/.test(part) ? part : "",
    units: chosen.get("units") === "in" ? "in" : "mm",
  };
}
