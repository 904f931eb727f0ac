// Circularity plots: the radial deviation of each run over the angle, as ISO 230-4 draws them.

const POLAR_SIZE = 300;
// Radius of the nominal circle, and the room for deviations on either side of it.
const NOMINAL = 92;
const ROOM = 40;

class CircularityPlots {
  constructor(model, state) {
    Object.assign(this, { model, state, circle: 0, body: $("circularity") });
    if (!this.body) return;
    this.plots = document.createElement("div");
    this.plots.className = "polar-plots";
    const names = model.circles.map((c, i) => [String(i), circleName(c), [circleName(c)]]);
    const choice = this.body.appendChild(document.createElement("div"));
    choice.className = "segments";
    choice.setAttribute("role", "group");
    choice.setAttribute("aria-label", "Circle shown");
    choice.hidden = names.length < 2;
    segments(choice, names, "0", (name) => { this.circle = Number(name); this.draw(); });
    this.body.append(this.plots);
    this.draw();
  }

  draw() {
    if (!this.body) return;
    const circle = this.model.circles[this.circle];
    const runs = this.model.runs.filter((r) => circle.runs[r.index] && !this.state.hidden.has(r.index));
    const largest = (run) => Math.max(1e-6, ...circle.runs[run.index].radial_um.map((v) => Math.abs(v ?? 0)));
    const common_um = Math.max(1e-6, ...runs.map(largest));
    this.plots.replaceChildren(...runs.map((run) =>
      polarPlot(circle, run, this.state.own ? largest(run) : common_um)));
  }
}

function circleName(circle) {
  return `${circle.plane} R ${+circle.radius_mm.toFixed(3)} ${LENGTH_UNIT}, line ${circle.line}`;
}

function svgElement(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

// One run: deviations are drawn outwards and inwards of the nominal circle, `largest_um` as far as there is room.
function polarPlot(circle, run, largest_um) {
  const { g_um, radial_um } = circle.runs[run.index], middle = POLAR_SIZE / 2;
  const step_um = roundStep(largest_um / 1.5), scale = ROOM / Math.max(largest_um, step_um);
  const figure = document.createElement("figure");
  figure.className = "polar";
  const svg = figure.appendChild(svgElement("svg", {
    viewBox: `0 0 ${POLAR_SIZE} ${POLAR_SIZE}`, role: "img",
    "aria-label": `Circularity of ${run.name}: circular deviation ${formatNumber(g_um)} ${ERROR_UNIT}`,
  }));
  const ring = (r, kind) => svg.append(svgElement("circle", { cx: middle, cy: middle, r, class: kind }));
  for (let k = -Math.floor(ROOM / scale / step_um); k * step_um * scale <= ROOM; k++) {
    ring(NOMINAL + k * step_um * scale, k === 0 ? "nominal" : "ring");
  }
  const [first, second] = circle.plane;
  const reach = NOMINAL + ROOM;
  svg.append(svgElement("path", { d: `M${middle - reach} ${middle}h${2 * reach}M${middle} ${middle - reach}v${2 * reach}`, class: "ring" }));
  svg.append(svgElement("text", { x: middle + reach + 3, y: middle + 4 }, `${first}+`));
  svg.append(svgElement("text", { x: middle + 4, y: middle - reach - 2 }, `${second}+`));
  svg.append(svgElement("text", { x: middle, y: middle - 6, "text-anchor": "middle" }, `${+step_um.toPrecision(2)} ${ERROR_UNIT}`));
  svg.append(svgElement("text", { x: middle, y: middle + 14, "text-anchor": "middle" }, "a division"));
  svg.append(svgElement("path", { d: polarPath(radial_um, middle, scale), class: `trace run-${run.index % 6}` }));
  const caption = figure.appendChild(document.createElement("figcaption"));
  caption.append(swatch(run.index), `${run.name}: G ${formatNumber(g_um)} ${ERROR_UNIT}`);
  return figure;
}

function polarPath(radial_um, middle, scale) {
  let d = "", open = false;
  const n = radial_um.length, closed = radial_um.every((v) => v !== null);
  radial_um.forEach((um, i) => {
    if (um === null) {
      open = false;
      return;
    }
    const angle = (i + 0.5) / n * TAU, r = NOMINAL + scale * um;
    d += `${open ? "L" : "M"}${(middle + r * Math.cos(angle)).toFixed(2)} ${(middle - r * Math.sin(angle)).toFixed(2)}`;
    open = true;
  });
  return closed ? d + "Z" : d;
}
