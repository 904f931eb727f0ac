// Runs the tool along the path, with the line of the program beside it.

// Lines shown before and behind the one that is being cut.
const LINES_AROUND = 3;
// Seconds of the page in a second of the cut.
const SPEEDS = [0.01, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 20, 100, 500, 2000];
// Part of the run that an arrow key goes on by, and a small one with Shift.
const STEP = 0.01;
const SMALL_STEP = 0.001;

class Player {
  constructor(model, state, actions) {
    Object.assign(this, { model, state, actions, playing: false, last: 0 });
    this.begin_s = Math.min(...model.runs.map((r) => r.t[0]));
    this.end_s = Math.max(...model.runs.map((r) => r.t[r.n - 1]));
    this.t_s = this.begin_s;
    this.lines = new Map();
    for (const [first, text] of model.listing) {
      text.split("\n").forEach((line, k) => this.lines.set(first + k, line));
    }
    this.button = $("play");
    this.slider = $("play-time");
    this.speed = $("play-speed");
    for (const speed of SPEEDS) this.speed.append(new Option(`${speed}×`, String(speed), speed === 1, speed === 1));
    this.speed.value = String(startSpeed(this.end_s - this.begin_s));
    this.button.addEventListener("click", () => this.toggle());
    this.slider.addEventListener("input", () => {
      this.go(this.begin_s + this.slider.value / 1000 * (this.end_s - this.begin_s));
    });
    document.addEventListener("keydown", (event) => this.key(event));
    this.showLines(null);
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.t_s >= this.end_s) this.t_s = this.begin_s;
    this.button.setAttribute("aria-pressed", String(this.playing));
    this.button.textContent = this.playing ? "Pause" : "Play";
    this.last = performance.now();
    if (this.playing) requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    if (!this.playing) return;
    const step_s = Math.min(0.1, (now - this.last) / 1000) * Number(this.speed.value);
    this.last = now;
    this.go(this.t_s + Math.max(0, step_s));
    if (this.t_s >= this.end_s) this.toggle();
    else requestAnimationFrame((next) => this.frame(next));
  }

  go(t_s) {
    this.t_s = Math.min(this.end_s, Math.max(this.begin_s, t_s));
    this.actions.stay(this.t_s);
  }

  // Follows a place that was chosen elsewhere.
  showPlace(t_s, line) {
    if (!this.playing) this.t_s = t_s;
    const span_s = Math.max(1e-9, this.end_s - this.begin_s);
    this.slider.value = String(Math.round(1000 * (t_s - this.begin_s) / span_s));
    this.slider.setAttribute("aria-valuetext", `${t_s.toFixed(2)} seconds, line ${line}`);
    this.showLines(line);
  }

  // Space and arrows, where no control under the focus has a use of its own for them.
  key(event) {
    if (event.target.closest("button, input, select, summary, a, canvas, [contenteditable], .plot-body")) {
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step_s = (event.shiftKey ? SMALL_STEP : STEP) * (this.end_s - this.begin_s);
    if (event.key === " ") this.toggle();
    else if (event.key === "ArrowRight") this.go(this.t_s + step_s);
    else if (event.key === "ArrowLeft") this.go(this.t_s - step_s);
    else return;
    event.preventDefault();
  }

  showLines(line) {
    const list = $("listing");
    if (!this.lines.size) {
      list.hidden = true;
      return;
    }
    const middle = line ?? 1 + LINES_AROUND, rows = [];
    for (let n = Math.max(1, middle - LINES_AROUND); n <= middle + LINES_AROUND; n++) {
      const row = document.createElement("li");
      row.value = n;
      row.textContent = this.lines.get(n) ?? (n === line ? "(the text of this line is not in the report)" : "");
      if (n === line) row.setAttribute("aria-current", "true");
      rows.push(row);
    }
    list.replaceChildren(...rows);
  }
}

// The speed at which a run takes some ten seconds.
function startSpeed(span_s) {
  const wanted = span_s / 10;
  return SPEEDS.reduce((best, s) => (Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best), 1);
}
