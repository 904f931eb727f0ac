// Plays a cut: the time of the tool, by button, slider or keyboard.

import type { Cut } from "./messages";

export class Playback {
  onMove: (index: number) => void = () => {};
  #cut: Cut | undefined;
  #index = 0;
  #began: { at: number; t_s: number } | undefined;

  constructor(
    private play: HTMLButtonElement, private slider: HTMLInputElement, private speed: HTMLSelectElement,
  ) {
    play.addEventListener("click", () => (this.#began ? this.stop() : this.#start()));
    slider.addEventListener("input", () => {
      this.stop();
      this.time(Number(slider.value));
    });
    speed.addEventListener("change", () => this.#began && this.#start());
  }

  show(cut: Cut | undefined): void {
    this.stop();
    this.#cut = cut;
    this.#index = 0;
    const end = cut ? cut.t_s[cut.t_s.length - 1] : 0;
    [this.slider.max, this.slider.step, this.slider.value] = [String(end), String(end / 2000 || 1), "0"];
    this.play.disabled = this.slider.disabled = this.speed.disabled = !cut;
  }

  /** The tool goes to where it is at a time. */
  time(t_s: number): void {
    const times = this.#cut?.t_s;
    if (!times) return;
    let [low, high] = [0, times.length - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < t_s) low = middle + 1;
      else high = middle;
    }
    this.index(low > 0 && t_s - times[low - 1] < times[low] - t_s ? low - 1 : low);
  }

  index(index: number): void {
    if (!this.#cut) return;
    this.#index = index;
    this.slider.value = String(this.#cut.t_s[index]);
    this.onMove(index);
  }

  stop(): void {
    this.#began = undefined;
    this.play.textContent = "Play";
  }

  #start(): void {
    const times = this.#cut?.t_s;
    if (!times) return;
    const t_s = this.#index >= times.length - 1 ? 0 : times[this.#index], began = { at: performance.now(), t_s };
    this.#began = began;
    this.play.textContent = "Pause";
    const step = () => {
      if (this.#began !== began) return;
      const now_s = t_s + ((performance.now() - began.at) / 1000) * Number(this.speed.value);
      this.time(now_s);
      if (now_s >= times[times.length - 1]) this.stop();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }
}
