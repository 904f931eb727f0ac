// The machine that a log tells: verdict and numbers of each axis, the machine file, the page of the identification.

import { $, element, save } from "./dom";
import type { Identified, IdentifiedAxis } from "./messages";

let shown: { stem: string; identified: Identified } | undefined;

/** Shows what the log of this name came to. */
export function showIdentified(stem: string, log: string, identified: Identified): void {
  shown = { stem, identified };
  const { axes, findings, improvements, advice } = identified;
  $("log").textContent = `${log}. Numbers with their intervals of 90 %. Run cuts on this machine.`;
  $("axes").replaceChildren(...axes.map(axisPart), ...[["What the log is taken for", findings], ["What would be better", improvements], ["What to record next", advice]]
    .map(([title, lines]) => listPart(title as string, lines as string[])));
  $("identified").hidden = false;
}

function axisPart({ name, verdict, numbers }: IdentifiedAxis): HTMLElement {
  const part = element("div"), table = element("table"), body = element("tbody"), head = element("tr");
  head.append(...["Number", "Value", "90 %"].map((text) => Object.assign(element("th", text), { scope: "col" })));
  table.append(element("thead"), body);
  table.tHead!.append(head);
  body.append(...numbers.map(([number, value, unit, interval, source]) => {
    const row = element("tr"), heading = element("th", number);
    heading.scope = "row";
    heading.append(element("small", source));
    row.append(heading, element("td", `${value} ${unit}`), element("td", interval.replace(" to ", " – ")));
    return row;
  }));
  part.append(element("h3", `Axis ${name}`), element("p", verdict.replace(/ um\b/g, " µm")), table);
  return part;
}

function listPart(title: string, lines: string[]): HTMLElement {
  const part = element("details"), list = element("ul");
  part.hidden = !lines.length;
  list.append(...lines.map((line) => element("li", line)));
  part.append(element("summary", title), list);
  return part;
}

export function listenToIdentified(): void {
  $("machine-file").addEventListener("click", () => shown && save(`${shown.stem}.toml`, new Blob([shown.identified.file], { type: "text/plain" })));
  $("identification").addEventListener("click", () => shown && save(`${shown.stem}.html`, shown.identified.page));
}
