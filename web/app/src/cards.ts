// The examples that a first visit shows.

import { errorColor } from "../../../crates/feedwright/assets/report/theme.js";
import { $, element } from "./dom";
import type { Engine } from "./engine";
import { EXAMPLES } from "./examples";

/** The examples, each with its path. */
export async function showCards(drawer: Engine, open: (example: string) => void): Promise<void> {
  const cards = Object.entries(EXAMPLES).map(([name, { about }]) => {
    const card = element("button"), canvas = element("canvas");
    card.type = "button";
    card.dataset.example = name;
    canvas.setAttribute("aria-hidden", "true");
    card.append(canvas, element("b", name), element("span", about));
    card.addEventListener("click", () => open(name));
    return { card, canvas, name };
  });
  $("cards").replaceChildren(...cards.map(({ card }) => card));
  for (const { canvas, name } of cards) {
    const { points, kinds } = await drawer.ask({ task: "check", name, program: EXAMPLES[name].program });
    drawCard(canvas, points, kinds);
  }
}

function drawCard(canvas: HTMLCanvasElement, points: Float32Array, kinds: Uint32Array): void {
  const g = canvas.getContext("2d")!, ratio = devicePixelRatio, { clientWidth: w, clientHeight: h } = canvas;
  [canvas.width, canvas.height] = [w * ratio, h * ratio];
  const of = (axis: number) => points.filter((_, i) => i % 3 === axis), [xs, ys] = [of(0), of(1)];
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const scale = Math.min((w - 8) / (x1 - x0 || 1), (h - 8) / (y1 - y0 || 1));
  g.setTransform(ratio, 0, 0, ratio, w * ratio / 2, h * ratio / 2);
  g.strokeStyle = errorColor(0.1);
  g.lineWidth = 1.5;
  g.beginPath();
  xs.forEach((x, i) => {
    const at: [number, number] = [(x - (x0 + x1) / 2) * scale, -(ys[i] - (y0 + y1) / 2) * scale];
    if (kinds[i] & 1) g.lineTo(...at);
    else g.moveTo(...at);
  });
  g.stroke();
}
