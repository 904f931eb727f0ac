// Rows of the lists and tables of the page.

import { element } from "./dom";
import type { Cut, Figures, Finding } from "./messages";
import { errorText, errorUnit } from "./units";

/** A mistake or a warning; a click calls `go`. */
export function findingRow(finding: Finding, go: () => void): HTMLElement {
  const row = element("li", "", finding.severity), button = buttonOf(row, go);
  button.append(element("b", `${finding.line}:${finding.column} ${finding.severity}`), ` ${finding.message}`);
  if (finding.hint) button.append(element("small", `hint: ${finding.hint}`));
  return row;
}

/** A place of a cut; a click marks it and calls `go`. */
export function placeRow(value: string, line: number, text: string, go: () => void): HTMLElement {
  const row = element("li"), button = buttonOf(row, () => {
    go();
    row.parentElement!.querySelectorAll("[aria-current]").forEach((old) => old.removeAttribute("aria-current"));
    button.setAttribute("aria-current", "true");
  });
  button.append(element("b", value), element("span", `line ${line}`), element("code", text));
  return row;
}

/** Lines that take longest, with the time of each in all of its turns, and when the first turn begins. */
export function slowestLines({ t_s, line }: Cut, most: number): { line: number; time_s: number; t_s: number }[] {
  const found = new Map<number, { line: number; time_s: number; t_s: number }>();
  for (let k = 0; k + 1 < t_s.length; k++) {
    const of = found.get(line[k]) ?? { line: line[k], time_s: 0, t_s: t_s[k] };
    of.time_s += t_s[k + 1] - t_s[k];
    found.set(line[k], of);
  }
  return [...found.values()].sort((a, b) => b.time_s - a.time_s).slice(0, most);
}

function buttonOf(row: HTMLElement, click: () => void): HTMLButtonElement {
  const button = row.appendChild(element("button"));
  button.type = "button";
  button.addEventListener("click", click);
  return button;
}

/** Fills a table whose rows have a name, in the color of its look where there is one, and numbers. */
export function fillTable(table: HTMLElement, rows: { name: string; look?: string; numbers: string[] }[]): void {
  table.querySelectorAll(".unit").forEach((unit) => (unit.textContent = errorUnit()));
  table.querySelector("tbody")!.replaceChildren(...rows.map(({ name, look, numbers }) => {
    const row = element("tr"), head = element("th", name, look ? `run ${look}` : "");
    head.scope = "row";
    row.append(head, ...numbers.map((number) => element("td", number)));
    return row;
  }));
}

/** The numbers of a cut. */
export const numbersOf = ({ name, time_s, rms_um, max_um }: Figures) => ({ name, numbers: [time_s, errorText(rms_um), errorText(max_um)] });
