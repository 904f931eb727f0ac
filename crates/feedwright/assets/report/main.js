// Puts the page together: controls, drawings, and the place that all of them show.

root.classList.add("js");
const $ = (id) => document.getElementById(id);
if (!window.DecompressionStream) {
  $("too-old").hidden = false;
  document.querySelector(".cockpit").hidden = true;
  return;
}
const model = readModel(await inflated($("data").textContent));
const options = new URLSearchParams(location.hash.slice(1));

if (model.runs.some((run) => run.n > 1)) start();
else document.querySelector(".cockpit").hidden = true;

function start() {
  const [low, high] = extent(model);
  const threeD = model.axes === 3 && high[2] - low[2] > 1e-6;
  const size_mm = Math.hypot(...high.map((v, k) => v - low[k]));
  const state = new ViewState(model, size_mm, threeD);
  const actions = new Actions(state);
  const plots = new Plots(model, state, $("plots"), $("others"), actions);
  const circularity = model.circles.length && $("circularity") ? new CircularityPlots(model, state) : null;
  const player = new Player(model, state, actions);
  Object.assign(actions, { plots, player });

  function layOut() {
    $("views").className = state.shown.length > 1 ? "side" : "";
    state.views = state.shown.map((r) => new PathView(model, model.runs[r], state, actions));
    $("views").replaceChildren(...state.views.map((v) => v.element));
    state.camera.fitted = false;
    state.views.forEach((v) => v.resize());
    setGain(state.gain);
    drawLegends(state);
  }

  const choices = model.runs.map((r) => [String(r.index), r.name, [swatch(r.index), r.name]]);
  if (model.runs.length > 1) choices.push(["side", "side by side", ["side by side"]]);
  const showChoice = segments($("show"), choices, String(state.shown[0]), (name) => {
    const before = state.lead();
    state.shown = name === "side" ? model.runs.map((r) => r.index) : [Number(name)];
    if (state.own) state.gain *= state.defaults[state.lead().index] / state.defaults[before.index];
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

  function setGain(gain) {
    state.gain = Math.min(MOST_GAIN, Math.max(1, gain));
    const text = state.shown.map((r) => `${+state.gainOf(model.runs[r]).toPrecision(2)}\u00d7`);
    $("gain").value = Math.round(100 * Math.log10(state.gain));
    $("gain-value").textContent = [...new Set(text)].join(", ");
    $("gain").setAttribute("aria-valuetext", $("gain-value").textContent);
    actions.redraw();
  }
  $("gain").addEventListener("input", () => setGain(10 ** ($("gain").value / 100)));
  const scaleChoice = segments($("scale"), [["own", "Scale per controller", ["scale per controller"]], ["common", "Common scale", ["common"]]],
    state.own ? "own" : "common", (name) => {
      state.own = name === "own";
      state.gain = state.own ? state.defaults[state.lead().index] : Math.min(...state.defaults);
      setGain(state.gain);
      drawLegends(state);
      circularity?.draw();
    });
  $("scale").hidden = model.runs.length < 2;
  const axisChoice = segments($("error-axis"), [["linear", "Linear axis of the error", ["linear"]], ["log", "Logarithmic axis of the error", ["logarithmic"]]],
    state.log ? "log" : "linear", (name) => {
      state.log = name === "log";
      plots.build();
    });

  function repaint() {
    drawLegends(state);
    plots.build();
    circularity?.draw();
    actions.redraw();
  }
  const setTheme = setUpTheme($("theme"), repaint);
  drawKey(state, () => {
    plots.build();
    circularity?.draw();
  });
  connectZoom(state, actions);
  connectPlaces(state, actions, showChoice);
  new ResizeObserver(() => { state.views.forEach((v) => v.resize()); actions.redraw(); }).observe($("views"));

  if (options.get("theme")) setTheme(options.get("theme"));
  if (options.get("view") && threeD) viewChoice(options.get("view"));
  if (options.get("scale")) scaleChoice(options.get("scale"));
  if (options.get("error")) axisChoice(options.get("error"));
  const roomy = innerWidth >= 700 && model.runs.length === 2;
  showChoice(options.get("show") || (roomy ? "side" : String(state.shown[0])));
  if (Number(options.get("gain"))) setGain(Number(options.get("gain")));
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
      camera.center = foot.map((c, k) => c[i] + state.gainOf(model.runs[run]) / 2 * deviation[k][i]);
      actions.stay(model.runs[run].t[i], run, i);
      actions.redraw();
      document.querySelector(".path-panel").scrollIntoView({ block: "nearest", behavior: "smooth" });
    };
    row.addEventListener("click", choose);
  }
}

// The runs by their colours: buttons that switch them off in the curves.
function drawKey(state, changed) {
  for (const run of model.runs) {
    const button = $("key").appendChild(document.createElement("button"));
    button.type = "button";
    button.append(swatch(run.index), run.name);
    button.setAttribute("aria-pressed", "true");
    button.disabled = model.runs.length < 2;
    button.addEventListener("click", () => {
      if (!state.hidden.delete(run.index) && state.hidden.size < model.runs.length - 1) state.hidden.add(run.index);
      button.setAttribute("aria-pressed", String(!state.hidden.has(run.index)));
      changed();
    });
  }
  if (model.tolerance_um) {
    const dash = document.createElement("span");
    dash.className = "dash";
    $("key").append(dash, `tolerance ${formatNumber(model.tolerance_um)} ${ERROR_UNIT}`);
  }
}

function connectZoom(state, actions) {
  const zoom = (factor) => () => {
    const { camera } = state;
    camera.zoom(factor, camera.width / 2, camera.height / 2);
    actions.redraw();
  };
  $("zoom-in").addEventListener("click", zoom(1.5));
  $("zoom-out").addEventListener("click", zoom(1 / 1.5));
  $("zoom-all").addEventListener("click", () => actions.reset());
  $("touch-moves").addEventListener("click", () => {
    state.touchMoves = !state.touchMoves;
    $("touch-moves").setAttribute("aria-pressed", String(state.touchMoves));
    $("views").classList.toggle("touch-moves", state.touchMoves);
  });
}

// A colour scale for each run that is shown, or one for all.
function drawLegends(state) {
  const runs = state.own ? state.shown.map((r) => model.runs[r]) : [null];
  $("legends").replaceChildren(...runs.map((run) => {
    const legend = document.createElement("div"), bar = document.createElement("canvas");
    legend.className = "legend";
    bar.width = 256;
    bar.height = 1;
    bar.setAttribute("role", "img");
    bar.setAttribute("aria-label", "Colour scale of the contour error");
    const g = bar.getContext("2d");
    for (let x = 0; x < 256; x++) {
      g.fillStyle = errorColor(x / 255);
      g.fillRect(x, 0, 1, 1);
    }
    const scale_um = state.scaleOf(run ?? state.lead()), end = document.createElement("span");
    end.append(`${formatNumber(scale_um)} ${ERROR_UNIT} contour error`);
    if (run && runs.length > 1) end.append(" ", swatch(run.index), run.name);
    legend.append("0", bar, end);
    return legend;
  }));
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
