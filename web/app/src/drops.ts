// Files that are dropped.

import { $ } from "./dom";

/** Calls `open` with the files that are dropped anywhere on the page. */
export function listenToDrops(open: (files: Iterable<File>) => Promise<void>): void {
  let depth = 0;
  const over = (now: number) => {
    depth = Math.max(0, now);
    $("drop").hidden = depth === 0;
  };
  addEventListener("dragenter", (event) => { event.preventDefault(); over(depth + 1); });
  addEventListener("dragleave", () => over(depth - 1));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    over(0);
    void open([...(event.dataTransfer?.files ?? [])]);
  });
}
