// Rows of the lists and tables of the page.

import { element } from "./dom";
import type { Figures, Finding, Place } from "./messages";
import { errorText, errorUnit } from "./units";

/** A mistake or a warning; a click calls `go`. */
export function findingRow(finding: Finding, go: () => void): HTMLElement {
  const row = element("li", "", finding.severity), button = buttonOf(row, go);
  button.append(element("b", `${finding.line}:${finding.column} ${finding.severity}`), ` ${finding.message}`);
  if (finding.hint) button.append(element("small", `hint: ${finding.hint}`));
  return row;
}

/** A worst place; a click marks it and calls `go`. */
export function worstRow(place: Place, go: () => void): HTMLElement {
  const row = element("li"), button = buttonOf(row, () => {
    go();
    row.parentElement!.querySelectorAll("[aria-current]").forEach((old) => old.removeAttribute("aria-current"));
    button.setAttribute("aria-current", "true");
  });
  button.append(element("b", `${errorText(Math.abs(place.error_um))} ${errorUnit()}`), element("span", `line ${place.line}`), element("code", place.text));
  return row;
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
