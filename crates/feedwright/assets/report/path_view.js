// Draws the programmed path and the tool's path of one run, the deviation enlarged and coloured by contour error.

const COLOR_STEPS = 48;
const HOVER_REACH_PX = 40;

class PathView {
  constructor(model, run, state, actions) {
    Object.assign(this, { model, run, state, actions });
    this.element = document.createElement("figure");
    this.element.className = "path-view";
    this.canvas = this.element.appendChild(document.createElement("canvas"));
    this.overlay = this.element.appendChild(document.createElement("canvas"));
    this.overlay.tabIndex = 0;
    this.overlay.setAttribute("role", "img");
    this.overlay.setAttribute("aria-label",
      `Path of ${run.name}, coloured by contour error. Arrows move, plus and minus zoom, 0 shows all, Enter plays.`);
    const caption = this.element.appendChild(document.createElement("figcaption"));
    caption.append(swatch(run.index), run.name);
    this.note = this.element.appendChild(document.createElement("p"));
    this.note.className = "folds";
    this.note.textContent = "dotted: folded by the enlargement, not by the tool";
    this.screen = new Float32Array(2 * run.n);
    listenToPointer(this);
    listenToKeys(this);
  }

  resize() {
    const { width, height } = this.element.getBoundingClientRect();
    const ratio = devicePixelRatio || 1;
    for (const c of [this.canvas, this.overlay]) {
      c.width = Math.max(1, Math.round(width * ratio));
      c.height = Math.max(1, Math.round(height * ratio));
      c.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    this.state.camera.resize(width, height);
  }

  draw() {
    const g = this.canvas.getContext("2d"), camera = this.state.camera;
    g.clearRect(0, 0, camera.width, camera.height);
    g.lineJoin = g.lineCap = "round";
    if (camera.view === "3d") drawTriad(g, camera); else drawGrid(g, camera);
    this.drawOutline(g);
    this.drawTool(g);
    drawScaleBars(g, camera, this.state.gainOf(this.run));
    this.drawMark();
  }

  drawOutline(g) {
    const { outline } = this.model, camera = this.state.camera;
    if (!outline) return;
    const [x, y, z] = outline.points;
    for (const cutting of [0, 1]) {
      g.beginPath();
      for (let i = 1; i < x.length; i++) {
        if (outline.cutting[i] !== cutting) continue;
        if (i === 1 || outline.cutting[i - 1] !== cutting) {
          g.moveTo(camera.x(x[i - 1], y[i - 1], z[i - 1]), camera.y(x[i - 1], y[i - 1], z[i - 1]));
        }
        g.lineTo(camera.x(x[i], y[i], z[i]), camera.y(x[i], y[i], z[i]));
      }
      g.setLineDash(cutting ? [] : [3, 5]);
      g.lineWidth = 1;
      g.strokeStyle = color(cutting ? "--path" : "--rapid");
      g.stroke();
    }
    g.setLineDash([]);
  }

  drawTool(g) {
    const { run, screen } = this, { camera } = this.state;
    const gain = this.state.gainOf(run), scale_um = this.state.scaleOf(run);
    const [fx, fy, fz] = run.foot, [dx, dy, dz] = run.deviation;
    const byColor = Array.from({ length: COLOR_STEPS + 1 }, () => []);
    for (let i = 0; i < run.n; i++) {
      const k = run.cutting[i] ? gain : 1;
      const p = [fx[i] + k * dx[i], fy[i] + k * dy[i], fz[i] + k * dz[i]];
      screen[2 * i] = camera.x(...p);
      screen[2 * i + 1] = camera.y(...p);
      if (i > 0 && run.cutting[i] && run.cutting[i - 1]) {
        const size = Math.max(Math.abs(run.error_um[i]), Math.abs(run.error_um[i - 1]));
        const shade = Math.min(COLOR_STEPS - 1, Math.floor(size / scale_um * COLOR_STEPS));
        byColor[isFolded(run, i, gain) ? COLOR_STEPS : shade].push(i);
      }
    }
    this.note.hidden = !byColor[COLOR_STEPS].length;
    byColor.forEach((indices, c) => {
      if (!indices.length) return;
      const folded = c === COLOR_STEPS;
      g.lineWidth = folded ? 1.25 : 2;
      g.setLineDash(folded ? [1, 3] : []);
      g.beginPath();
      let end = -1;
      for (const i of indices) {
        if (end !== i - 1) g.moveTo(screen[2 * i - 2], screen[2 * i - 1]);
        g.lineTo(screen[2 * i], screen[2 * i + 1]);
        end = i;
      }
      g.strokeStyle = folded ? color("--ink-3") : errorColor((c + 0.5) / COLOR_STEPS);
      g.stroke();
    });
    g.setLineDash([]);
  }

  drawMark() {
    const g = this.overlay.getContext("2d"), { camera, focus } = this.state;
    g.clearRect(0, 0, camera.width, camera.height);
    const i = focus && focus.indices[this.run.index];
    if (i === undefined || i === null || !focus) return;
    const [x, y] = [this.screen[2 * i], this.screen[2 * i + 1]];
    const foot = this.run.foot.map((c) => c[i]);
    g.strokeStyle = g.fillStyle = color("--ink");
    g.lineWidth = 1.5;
    g.beginPath();
    g.moveTo(camera.x(...foot), camera.y(...foot));
    g.lineTo(x, y);
    g.stroke();
    g.beginPath();
    g.arc(x, y, 6, 0, TAU);
    g.fillStyle = color("--panel");
    g.fill();
    g.stroke();
    g.beginPath();
    g.arc(x, y, 2.5, 0, TAU);
    g.fillStyle = color("--ink");
    g.fill();
  }

  // Index of the point drawn nearest to a place on the screen, if one is near.
  pick(x, y) {
    let best = -1, least = HOVER_REACH_PX ** 2;
    for (let i = 0; i < this.run.n; i++) {
      const distance = (this.screen[2 * i] - x) ** 2 + (this.screen[2 * i + 1] - y) ** 2;
      if (distance < least && this.run.cutting[i]) [best, least] = [i, distance];
    }
    return best;
  }
}

// Whether the curve, enlarged, runs backwards between two points where the tool itself runs forwards: where the path bends more
// sharply than the enlarged deviation is long, enlarging makes loops that nobody cut.
function isFolded(run, i, gain) {
  let drawn = 0, cut = 0;
  for (let k = 0; k < 3; k++) {
    const along = run.foot[k][i] - run.foot[k][i - 1], aside = run.deviation[k][i] - run.deviation[k][i - 1];
    drawn += along * (along + gain * aside);
    cut += along * (along + aside);
  }
  return drawn < 0 && cut >= 0;
}

function swatch(i) {
  const span = document.createElement("span");
  span.className = `swatch run-${i % 6}`;
  return span;
}

function canvasFont(size, weight = 400) {
  return `${weight} ${size}px ${getComputedStyle(document.body).fontFamily}`;
}

// Grid with numbers along the left and the lower edge of a plane view.
function drawGrid(g, camera) {
  const step = roundStep(Math.max(camera.width, 500) / camera.scale / 5);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const names = PLANES[camera.view], axis = names.map((n) => "XYZ".indexOf(n));
  g.font = canvasFont(11);
  g.strokeStyle = color("--grid");
  g.fillStyle = color("--ink-3");
  g.lineWidth = 1;
  const text = (v) => (v < -1e-9 ? "\u2212" : "") + Math.abs(v).toFixed(decimals);
  const halves = [camera.width, camera.height].map((l) => l / 2 / camera.scale);
  for (const side of [0, 1]) {
    const middle = camera.center[axis[side]];
    const first = Math.ceil((middle - halves[side]) / step), last = Math.floor((middle + halves[side]) / step);
    for (let k = first; k <= last; k++) {
      const at = (k * step - middle) * camera.scale;
      g.beginPath();
      if (side === 0) {
        const x = Math.round(camera.width / 2 + at) + 0.5;
        g.moveTo(x, 0);
        g.lineTo(x, camera.height);
        g.textAlign = "center";
        if (x > 34 && x < camera.width - 58) g.fillText(text(k * step), x, camera.height - 7);
      } else {
        const y = Math.round(camera.height / 2 - at) + 0.5;
        g.moveTo(0, y);
        g.lineTo(camera.width, y);
        g.textAlign = "left";
        if (y > 46 && y < camera.height - 24) g.fillText(text(k * step), 6, y - 4);
      }
      g.stroke();
    }
  }
  g.textAlign = "right";
  g.fillText(`${names[0]}, ${LENGTH_UNIT}`, camera.width - 6, camera.height - 7);
  g.textAlign = "left";
  g.fillText(`${names[1]}, ${LENGTH_UNIT}`, 6, 36);
}

function drawTriad(g, camera) {
  const [x0, y0, length] = [44, camera.height - 44, 26];
  g.font = canvasFont(11, 600);
  g.strokeStyle = g.fillStyle = color("--ink-3");
  g.lineWidth = 1.25;
  g.textAlign = "center";
  g.textBaseline = "middle";
  AXIS_NAMES.forEach((name, k) => {
    const [dx, dy] = [camera.right[k], -camera.up[k]];
    if (Math.hypot(dx, dy) < 0.12) return;
    g.beginPath();
    g.moveTo(x0, y0);
    g.lineTo(x0 + length * dx, y0 + length * dy);
    g.stroke();
    g.fillText(name.toUpperCase(), x0 + (length + 9) * dx, y0 + (length + 9) * dy);
  });
  g.textBaseline = "alphabetic";
}

// One bar, two readings: what it is on the part, and what it is as deviation.
function drawScaleBars(g, camera, gain) {
  const length = roundStep(Math.min(camera.width * 0.3, 150) / camera.scale);
  const [right, y] = [camera.width - 14, 22], left = right - length * camera.scale;
  const size = (mm) => (mm >= 0.9999 ? `${+mm.toPrecision(2)} ${LENGTH_UNIT}` : `${+(mm * 1e3).toPrecision(2)} ${ERROR_UNIT}`);
  g.strokeStyle = g.fillStyle = color("--ink-2");
  g.lineWidth = 1.5;
  g.beginPath();
  g.moveTo(left, y - 4);
  g.lineTo(left, y + 4);
  g.moveTo(left, y);
  g.lineTo(right, y);
  g.moveTo(right, y - 4);
  g.lineTo(right, y + 4);
  g.stroke();
  g.font = canvasFont(11);
  g.textAlign = "right";
  g.fillText(`part ${size(length)}`, right, y - 8);
  g.fillText(`deviation ${size(length / gain)}`, right, y + 17);
}
