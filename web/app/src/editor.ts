// The program: a text area with line numbers and marks.

import type { Finding } from "./messages";

export class Editor {
  onChange: () => void = () => {};
  #text: HTMLTextAreaElement;
  #gutter: HTMLElement;
  #marks = new Map<number, Finding["severity"]>();
  #current = 0;
  #lines = 1;

  constructor(text: HTMLTextAreaElement, gutter: HTMLElement) {
    [this.#text, this.#gutter] = [text, gutter];
    text.addEventListener("input", () => {
      this.#count();
      this.onChange();
    });
    text.addEventListener("scroll", () => this.#draw());
    new ResizeObserver(() => this.#draw()).observe(text);
  }

  get value(): string { return this.#text.value; }
  set value(program: string) {
    this.#text.value = program;
    this.#text.scrollTop = this.#current = 0;
    this.#marks.clear();
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
    const lines = this.value.split("\n"), before = lines.slice(0, line - 1).reduce((sum, text) => sum + text.length + 1, 0);
    const at = before + Math.max(0, column - 1);
    this.#text.focus();
    this.#text.setSelectionRange(at, at + length);
    this.#reveal(line);
  }

  get #lineHeight(): number { return parseFloat(getComputedStyle(this.#text).lineHeight); }

  #reveal(line: number): void {
    const height = this.#lineHeight, y = (line - 1) * height, { scrollTop, clientHeight } = this.#text;
    if (y < scrollTop || y > scrollTop + clientHeight - 2 * height) this.#text.scrollTop = y - clientHeight / 2;
  }

  #count(): void {
    const program = this.value;
    this.#lines = 1;
    for (let at = -1; (at = program.indexOf("\n", at + 1)) >= 0; ) this.#lines++;
    this.#draw();
  }

  /** Numbers of the lines that are seen: a program may have a million. */
  #draw(): void {
    const height = this.#lineHeight, { scrollTop, clientHeight } = this.#text;
    const first = Math.floor(scrollTop / height) + 1, last = Math.min(this.#lines, first + Math.ceil(clientHeight / height));
    const rows = [];
    for (let line = first; line <= last; line++) {
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
