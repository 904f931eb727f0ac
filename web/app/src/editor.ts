// The program: a text area with line numbers and marks. Of a long program the text area shows a part, to be read: browsers lay out a text area
// line by line, and one of two million lines takes minutes and gigabytes.

import type { Finding } from "./messages";

/** Characters of the longest program that can be edited. */
const LONGEST = 2 ** 21;
/** Lines of a longer one that are shown at a time. */
const PART = 4000;

export class Editor {
  onChange: () => void = () => {};
  #text: HTMLTextAreaElement;
  #gutter: HTMLElement;
  #marks = new Map<number, Finding["severity"]>();
  #current = 0;
  /** Lines of the text area, and those of the program before it. */
  #lines = 1;
  #before = 0;
  /** A long program, where its lines begin, and its end. */
  #long: { program: string; starts: Uint32Array } | undefined;

  constructor(text: HTMLTextAreaElement, gutter: HTMLElement) {
    [this.#text, this.#gutter] = [text, gutter];
    text.addEventListener("input", () => {
      this.#count();
      this.onChange();
    });
    text.addEventListener("scroll", () => {
      this.#goOn();
      this.#draw();
    });
    new ResizeObserver(() => this.#draw()).observe(text);
  }

  /** Whether the program is too long to be edited. */
  get isLong(): boolean { return !!this.#long; }

  get value(): string { return this.#long?.program ?? this.#text.value; }
  set value(program: string) {
    const isLong = program.length > LONGEST;
    this.#long = isLong ? { program, starts: lineStarts(program) } : undefined;
    this.#text.readOnly = isLong;
    this.#text.title = isLong ? "The program is too long to be edited here." : "";
    this.#current = this.#before = 0;
    this.#marks.clear();
    if (isLong) this.#part(0);
    else this.#text.value = program;
    this.#text.scrollTop = 0;
    this.#count();
  }

  mark(findings: Finding[]): void {
    this.#marks = new Map([...findings].reverse().map(({ line, severity }) => [line, severity]));
    this.#draw();
  }

  /** Marks the line that is cut, and shows it. */
  current(line: number): void {
    if (line === this.#current) return;
    this.#current = line;
    this.#reveal(line);
    this.#draw();
  }

  /** Puts the cursor into a line, from 1, at a column, from 1. */
  go({ line, column, length }: Pick<Finding, "line" | "column" | "length">): void {
    this.#reveal(line);
    const lines = this.#text.value.split("\n", line - this.#before), before = lines.slice(0, -1).reduce((sum, text) => sum + text.length + 1, 0);
    const at = before + Math.max(0, column - 1);
    this.#text.focus();
    this.#text.setSelectionRange(at, at + length);
    this.#reveal(line);
  }

  get #lineHeight(): number { return parseFloat(getComputedStyle(this.#text).lineHeight); }

  #reveal(line: number): void {
    if (this.#long && (line <= this.#before || line > this.#before + this.#lines)) this.#part(line - PART / 2);
    const height = this.#lineHeight, y = (line - 1 - this.#before) * height, { scrollTop, clientHeight } = this.#text;
    if (y < scrollTop || y > scrollTop + clientHeight - 2 * height) this.#text.scrollTop = y - clientHeight / 2;
  }

  /** Shows the part of a long program behind so many lines. */
  #part(before: number): void {
    const { program, starts } = this.#long!, count = starts.length - 1;
    this.#before = Math.max(0, Math.min(before, count - PART));
    this.#text.value = program.slice(starts[this.#before], starts[Math.min(count, this.#before + PART)]);
    this.#count();
  }

  /** At an end of the part, shows the next one with the same lines in their places. */
  #goOn(): void {
    if (!this.#long) return;
    const { scrollTop, scrollHeight, clientHeight } = this.#text, before = this.#before;
    if (scrollTop > 0 && scrollTop + clientHeight < scrollHeight - 1) return;
    this.#part(scrollTop > 0 ? before + PART / 2 : before - PART / 2);
    if (this.#before !== before) this.#text.scrollTop = scrollTop + (before - this.#before) * this.#lineHeight;
  }

  #count(): void {
    this.#lines = lineStarts(this.#text.value).length - 1;
    this.#draw();
  }

  /** Numbers of the lines that are seen. */
  #draw(): void {
    const height = this.#lineHeight, { scrollTop, clientHeight } = this.#text;
    const first = Math.floor(scrollTop / height) + 1, last = Math.min(this.#lines, first + Math.ceil(clientHeight / height));
    const rows = [];
    for (let line = this.#before + first; line <= this.#before + last; line++) {
      const row = document.createElement("div"), mark = this.#marks.get(line);
      row.textContent = String(line);
      if (mark) row.classList.add(mark);
      if (line === this.#current) row.classList.add("current");
      rows.push(row);
    }
    this.#gutter.replaceChildren(...rows);
    this.#gutter.style.setProperty("--shift", `${(first - 1) * height - scrollTop}px`);
  }
}

/** Where the lines of a text begin, and its end. */
function lineStarts(text: string): Uint32Array {
  let count = 1;
  for (let at = -1; (at = text.indexOf("\n", at + 1)) >= 0; ) count++;
  const starts = new Uint32Array(count + 1);
  for (let line = 1; line < count; line++) starts[line] = text.indexOf("\n", starts[line - 1]) + 1;
  starts[count] = text.length;
  return starts;
}
