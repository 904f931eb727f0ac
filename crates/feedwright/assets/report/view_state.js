// What the drawings show, and what changes it.

// Largest enlargement of the deviation.
const MOST_GAIN = 1e5;
// Runs whose largest errors differ by this factor are not read on one linear scale.
const FAR_APART = 8;

class ViewState {
  constructor(model, size_mm, threeD) {
    this.model = model;
    this.camera = new Camera(model.outline ? model.outline.points : model.runs[0].foot, threeD ? "3d" : "xy");
    this.defaults = model.runs.map((run) => defaultGain(run, size_mm));
    const largest = model.runs.map((run) => run.max_um).filter((um) => um > 0);
    const far = largest.length > 1 && Math.max(...largest) > FAR_APART * Math.min(...largest);
    // Whether each run has an enlargement and colours of its own, and whether the axis of the error is logarithmic.
    this.own = far;
    this.log = far;
    this.shown = [model.runs.length - 1];
    this.gain = this.own ? this.defaults[this.shown[0]] : Math.min(...this.defaults);
    this.hidden = new Set();
    this.focus = null;
    this.views = [];
    this.pinned = null;
    this.touchMoves = false;
  }

  // The run whose enlargement the slider tells, and whose place is read.
  lead() {
    return this.model.runs[this.shown[this.shown.length - 1]];
  }

  gainOf(run) {
    const ratio = this.own ? this.defaults[run.index] / this.defaults[this.lead().index] : 1;
    return Math.min(MOST_GAIN, Math.max(1, this.gain * ratio));
  }

  scaleOf(run) {
    const runs = this.own ? [run] : this.model.runs;
    return Math.max(1e-6, ...runs.map((r) => r.max_um));
  }
}

// Nine tenths of the cut are then within a twenty-fifth of the part, and the largest deviation within a quarter.
function defaultGain(run, size_mm) {
  const sizes = Array.from(run.error_um.filter((_, i) => run.cutting[i]), Math.abs).sort((a, b) => a - b);
  if (!sizes.length || !(run.max_um > 0)) return 1;
  const usual_mm = Math.max(sizes[Math.floor(0.9 * (sizes.length - 1))] * 1e-3, 1e-9);
  const gain = Math.min(size_mm / 25 / usual_mm, size_mm / 4 / (run.max_um * 1e-3));
  return roundStep(Math.min(MOST_GAIN, Math.max(1, gain)));
}

class Actions {
  constructor(state) {
    Object.assign(this, { state, waiting: false });
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.state.views.forEach((v) => v.draw());
    });
  }

  reset() {
    this.state.camera.fit();
    this.redraw();
  }

  play() {
    this.player.toggle();
  }

  // `kind` is "t" or "s"; a run and index may be given where the place is one of its points.
  focus(kind, value, run, index) {
    const { model } = this.state, indices = model.runs.map((r) => nearestIndex(r[kind], value));
    if (run !== undefined) indices[run] = index;
    const lead = run ?? this.state.lead().index, i = indices[lead];
    this.state.focus = { indices, lead, at: { t: model.runs[lead].t[i], s: model.runs[lead].s[i] } };
    this.state.focus.at[kind] = value;
    this.refresh();
  }

  // As `focus` at a time, and it stays there when the pointer leaves.
  stay(t_s, run, index) {
    this.focus("t", t_s, run, index);
    this.state.pinned = this.state.focus;
  }

  unfocus() {
    this.state.focus = this.state.pinned;
    this.refresh();
  }

  // Shows the place that is chosen in every drawing.
  refresh() {
    const { state } = this, { model, focus } = state;
    this.plots.showFocus(focus);
    state.views.forEach((v) => v.drawMark());
    if (!focus) {
      $("readout").textContent = "";
      return;
    }
    const run = model.runs[focus.lead], i = focus.indices[focus.lead];
    const errors = model.runs.map((r) => {
      const k = focus.indices[r.index];
      return `${r.name} ${r.cutting[k] ? `${formatError(r.error_um[k])} ${ERROR_UNIT}` : "rapid"}`;
    });
    $("readout").textContent =
      [`line ${run.line[i]}`, `t ${run.t[i].toFixed(3)} s`, `s ${run.s[i].toFixed(LENGTH_UNIT === "in" ? 3 : 2)} ${LENGTH_UNIT}`, ...errors].join("  \u00b7  ");
    this.player.showPlace(focus.at.t, run.line[i]);
  }
}
