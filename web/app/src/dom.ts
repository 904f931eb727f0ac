// What the rooms of the page have in common: elements, buttons that are pressed, lists to choose from, downloads.

export const $ = <T extends HTMLElement = HTMLElement>(id: string) => document.getElementById(id) as T;

export function element<K extends keyof HTMLElementTagNameMap>(tag: K, text = "", name = ""): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  [made.textContent, made.className] = [text, name];
  return made;
}

export function press(selector: string, isPressed: (button: HTMLElement) => boolean): void {
  document.querySelectorAll<HTMLElement>(selector).forEach((button) => button.setAttribute("aria-pressed", String(isPressed(button))));
}

export function fill(select: HTMLSelectElement, rows: { name: string; about: string }[], chosen: string): void {
  select.append(...rows.map(({ name, about }) => {
    const option = new Option(name, name, name === chosen, name === chosen);
    option.title = about;
    return option;
  }));
}

export function save(name: string, content: Blob): void {
  const link = element("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
