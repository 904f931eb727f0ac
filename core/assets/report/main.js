// Puts the page together: controls, drawings, and the place that all of them show.

root.classList.add("js");
const $ = (id) => document.getElementById(id);
const model = readModel(JSON.parse($("data").textContent));
const options = new URLSearchParams(location.hash.slice(1));

if (model.runs.some((run) => run.n > 1)) start();
else document.querySelector(".cockpit").hidden = true;

function start() {
  const [low, high] = extent(model);
  const threeD = model.axes === 3 && high[2] - low[2] > 1e-6;
  const state = {
    camera: new Camera(model.outline ? model.outline.points : model.runs[0].foot, threeD ? "3d" : "xy"),
    gain: defaultGain(model, low, high),
    scale_um: Math.max(1e-3, ...model.runs.map((r) => r.max_um)),
    focus: null, shown: [model.runs.length - 1], views: [], pinned: false,
  };
  let waiting = false;
  const actions = {
    redraw() {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => { waiting = false; state.views.forEach((v) => v.draw()); });
    },
    reset() { state.camera.fit(); actions.redraw(); },
    // `kind` is "t" or "s"; a run and index may be given where the place is one of its points.
    focus(kind, value, run, index) {
      const indices = model.runs.map((r) => nearestIndex(r[kind], value));
      if (run !== undefined) indices[run] = index;
      const lead = run ?? state.shown[state.shown.length - 1], i = indices[lead];
      state.focus = { indices, at: { t: model.runs[lead].t[i], s: model.runs[lead].s[i] } };
      state.focus.at[kind] = value;
      showFocus(lead, i);
    },
    unfocus() {
      state.focus = state.pinned || null;
      if (state.pinned) return showFocus(state.pinned.lead, state.pinned.indices[state.pinned.lead]);
      plots.showFocus(null);
      $("readout").textContent = "";
      state.views.forEach((v) => v.drawMark());
    },
  };
  const plots = new Plots(model, $("plots"), document.querySelector(".path-panel"), actions);

  function showFocus(lead, i) {
    plots.showFocus(state.focus);
    const run = model.runs[lead];
    const errors = model.runs.map((r) => {
      const k = state.focus.indices[r.index];
      return `${r.name} ${r.cutting[k] ? `${formatNumber(r.error_um[k])} \u00b5m` : "rapid"}`;
    });
    $("readout").textContent =
      [`line ${run.line[i]}`, `t ${run.t[i].toFixed(3)} s`, `s ${run.s[i].toFixed(2)} mm`, ...errors].join("  \u00b7  ");
    state.views.forEach((v) => v.drawMark());
  }

  function layOut() {
    const both = state.shown.length > 1;
    $("views").className = both ? "side" : "";
    state.views = state.shown.map((r) => new PathView(model, model.runs[r], state, actions));
    $("views").replaceChildren(...state.views.map((v) => v.element));
    state.camera.fitted = false;
    state.views.forEach((v) => v.resize());
    actions.redraw();
  }

  const choices = model.runs.map((r) => [String(r.index), r.name, [swatch(r.index), r.name]]);
  if (model.runs.length > 1) choices.push(["side", "side by side", ["side by side"]]);
  const showChoice = segments($("show"), choices, String(state.shown[0]), (name) => {
    state.shown = name === "side" ? model.runs.map((r) => r.index) : [Number(name)];
    layOut();
  });
  $("show").hidden = model.runs.length < 2;
  const views = [["3d", "3D"], ["xy", "XY"], ["xz", "XZ"], ["yz", "YZ"]].map(([id, name]) => [id, name, [name]]);
  const viewChoice = segments($("view"), views, state.camera.view, (name) => {
    state.camera.setView(name);
    state.camera.fit();
    actions.redraw();
  });
  $("view").hidden = !threeD;

  const setGain = (gain) => {
    state.gain = Math.min(1000, Math.max(1, gain));
    $("gain").value = Math.round(100 * Math.log10(state.gain));
    $("gain-value").textContent = `${+state.gain.toPrecision(2)}\u00d7`;
    $("gain").setAttribute("aria-valuetext", `${+state.gain.toPrecision(2)} times`);
    actions.redraw();
  };
  $("gain").addEventListener("input", () => setGain(10 ** ($("gain").value / 100)));

  function repaint() {
    drawLegend(state.scale_um);
    plots.build();
    actions.redraw();
  }
  const setTheme = setUpTheme($("theme"), repaint);

  $("key").append(...model.runs.flatMap((r) => [swatch(r.index), `${r.name}  `]));
  if (model.tolerance_um) {
    const dash = document.createElement("span");
    dash.className = "dash";
    $("key").append(dash, `tolerance ${formatNumber(model.tolerance_um)} \u00b5m`);
  }
  connectPlaces(state, actions, showChoice);
  new ResizeObserver(() => { state.views.forEach((v) => v.resize()); actions.redraw(); }).observe($("views"));

  if (options.get("theme")) setTheme(options.get("theme"));
  if (options.get("view") && threeD) viewChoice(options.get("view"));
  const roomy = innerWidth >= 700 && model.runs.length === 2;
  showChoice(options.get("show") || (roomy ? "side" : String(state.shown[0])));
  setGain(Number(options.get("gain")) || state.gain);
  drawLegend(state.scale_um);
  root.dataset.ready = "";
}

// A row of buttons of which one is pressed. Returns a function that presses one.
function segments(container, choices, chosen, changed) {
  const buttons = choices.map(([name, label, content]) => {
    const button = container.appendChild(document.createElement("button"));
    button.type = "button";
    button.append(...content);
    button.setAttribute("aria-label", label);
    button.addEventListener("click", () => press(name));
    return [name, button];
  });
  const mark = (name) => buttons.forEach(([n, b]) => b.setAttribute("aria-pressed", n === name));
  function press(name) {
    if (!buttons.some(([n]) => n === name)) return;
    mark(name);
    changed(name);
  }
  mark(chosen);
  return press;
}

// Rows of the worst places, each with a button for the keyboard: choosing one shows it on the path and in the curves.
function connectPlaces(state, actions, showChoice) {
  for (const row of document.querySelectorAll("tr[data-place]")) {
    const run = Number(row.dataset.run), place = model.runs[run].worst[Number(row.dataset.place)];
    const button = document.createElement("button");
    button.type = "button";
    button.append(row.cells[0].textContent);
    button.setAttribute("aria-label", `Show place ${row.cells[0].textContent} on the path`);
    row.cells[0].replaceChildren(button);
    const choose = () => {
      document.querySelectorAll("tr[data-place].chosen").forEach((r) => r.classList.remove("chosen"));
      row.classList.add("chosen");
      if (!state.shown.includes(run)) showChoice(String(run));
      const { camera } = state, i = nearestIndex(model.runs[run].t, place.t_s);
      const before = camera.scale, { foot, deviation } = model.runs[run];
      camera.fit();
      camera.scale = Math.max(before, camera.scale * 4);
      camera.center = foot.map((c, k) => c[i] + state.gain / 2 * deviation[k][i]);
      actions.focus("t", model.runs[run].t[i], run, i);
      state.pinned = { ...state.focus, lead: run };
      actions.redraw();
      document.querySelector(".path-panel").scrollIntoView({ block: "nearest", behavior: "smooth" });
    };
    row.addEventListener("click", choose);
  }
}

function drawLegend(scale_um) {
  const g = $("legend-bar").getContext("2d");
  for (let x = 0; x < 256; x++) {
    g.fillStyle = errorColor(x / 255);
    g.fillRect(x, 0, 1, 1);
  }
  $("legend-high").textContent = `${formatNumber(scale_um)} \u00b5m contour error`;
}

// Box around the path and all runs.
function extent(model) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const take = (columns) => columns.forEach((values, k) => {
    for (const v of values) {
      if (v < low[k]) low[k] = v;
      if (v > high[k]) high[k] = v;
    }
  });
  if (model.outline) take(model.outline.points);
  model.runs.forEach((r) => take(r.foot));
  return [low, high];
}

// The largest deviation of the first run is then about a twelfth of the part.
function defaultGain(model, low, high) {
  const size = Math.hypot(...high.map((v, k) => v - low[k]));
  const largest_mm = Math.max(...model.runs.map((r) => r.max_um)) * 1e-3;
  return largest_mm > 0 ? roundStep(Math.min(1000, Math.max(1, size / 12 / largest_mm))) : 1;
}
