// The curves, drawn by uPlot: every plot has all runs, plots over the same quantity share cursor and range.

const PLOT_HEIGHT = 180;

// Shares below this many per cent are not drawn: logarithms need an end.
const LEAST_SHARE = 0.01;

class Plots {
  // `beside` takes the plot that has no place along the path.
  constructor(model, container, beside, actions) {
    Object.assign(this, { model, actions, busy: false });
    this.plots = definitions(model).map((definition) => {
      const figure = (definition.kind === "bins" ? beside : container).appendChild(document.createElement("figure"));
      figure.className = "plot";
      const caption = figure.appendChild(document.createElement("figcaption"));
      const title = caption.appendChild(document.createElement("b"));
      title.textContent = definition.title;
      const live = caption.appendChild(document.createElement("span"));
      live.className = "live";
      return { definition, live, body: figure.appendChild(document.createElement("div")), u: null };
    });
    this.build();
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(container);
    observer.observe(beside);
  }

  // Makes the charts anew, in the colours of the theme.
  build() {
    for (const plot of this.plots) {
      const range = plot.u && [plot.u.scales.x.min, plot.u.scales.x.max];
      if (plot.u) plot.u.destroy();
      plot.u = new uPlot(this.options(plot), plot.definition.data, plot.body);
      if (range) this.quietly(() => plot.u.setScale("x", { min: range[0], max: range[1] }));
    }
  }

  resize() {
    for (const plot of this.plots) {
      const width = plot.body.clientWidth;
      if (width > 0 && width !== plot.u.width) plot.u.setSize({ width, height: PLOT_HEIGHT });
    }
  }

  // Runs `work` without answering to what the charts report meanwhile.
  quietly(work) {
    const busy = this.busy;
    this.busy = true;
    work();
    this.busy = busy;
  }

  options(plot) {
    const { definition } = plot, axis = {
      stroke: color("--ink-3"), font: canvasFont(11), labelFont: canvasFont(11), labelSize: 18, gap: 4,
      grid: { stroke: color("--grid"), width: 1 }, ticks: { show: false },
    };
    const values = (u, splits) => splits.map((v) => (v === null ? "" : tickText(v)));
    return {
      width: Math.max(200, plot.body.clientWidth), height: PLOT_HEIGHT, padding: [10, 8, 0, 0],
      legend: { show: false },
      scales: { x: { time: false }, y: { range: definition.range, distr: definition.logarithmic ? 3 : 1 } },
      axes: [
        { ...axis, label: definition.x, size: 26, values, space: 60 },
        { ...axis, size: 50, values, space: 28, filter: definition.logarithmic ? decades : undefined },
      ],
      series: [{}, ...definition.series.map((s) => ({
        stroke: s.run === undefined ? "transparent" : runColor(s.run) , width: s.width ?? 1.5, dash: s.dash,
        alpha: s.alpha ?? 1, points: { show: false }, paths: definition.paths,
        fill: s.fill ? withAlpha(runColor(s.run), 0.18) : undefined, show: true,
        ...(s.edge ? { stroke: "transparent", width: 0 } : {}),
      }))],
      bands: definition.bands?.map((b) => ({ series: b.series, fill: withAlpha(runColor(b.run), 0.28) })),
      cursor: {
        y: false, drag: { x: true, y: false, setScale: true },
        points: { size: 7, fill: color("--panel"), width: 2, show: (u, i) => definition.series[i - 1].edge ? false : undefined },
      },
      hooks: {
        drawAxes: [(u) => this.drawLines(u, definition)],
        setCursor: [(u) => this.moved(plot, u)],
        setScale: [(u, key) => key === "x" && this.ranged(plot, u)],
      },
    };
  }

  // The zero line, and the tolerance where there is one.
  drawLines(u, definition) {
    if (!definition.levels) return;
    const g = u.ctx, ratio = devicePixelRatio || 1;
    for (const { value, dash } of definition.levels) {
      if (value < u.scales.y.min || value > u.scales.y.max) continue;
      const y = Math.round(u.valToPos(value, "y", true));
      g.save();
      g.strokeStyle = color(dash ? "--tolerance" : "--axis");
      g.lineWidth = ratio;
      g.setLineDash(dash ? [6 * ratio, 4 * ratio] : []);
      g.beginPath();
      g.moveTo(u.bbox.left, y);
      g.lineTo(u.bbox.left + u.bbox.width, y);
      g.stroke();
      g.restore();
    }
  }

  moved(plot, u) {
    if (this.busy) return;
    const { kind } = plot.definition, left = u.cursor.left;
    if (left === null || left < 0) {
      plot.live.replaceChildren();
      return kind === "bins" ? undefined : this.actions.unfocus();
    }
    if (kind !== "bins") return this.actions.focus(kind, u.posToVal(left, "x"));
    const i = u.cursor.idx;
    if (i === null || i === undefined) return;
    plot.live.replaceChildren(...this.model.runs.flatMap((run, r) =>
      [swatch(run.index), ` ${formatNumber(u.data[r + 1][i] < LEAST_SHARE ? 0 : u.data[r + 1][i])} % `]), `at ${formatNumber(u.data[0][i])} \u00b5m`);
  }

  ranged(plot, u) {
    if (this.busy) return;
    const { min, max } = u.scales.x;
    this.quietly(() => {
      for (const other of this.plots) {
        if (other !== plot && other.u && other.definition.kind === plot.definition.kind) other.u.setScale("x", { min, max });
      }
    });
  }

  // Moves all cursors to a place of the runs; `at` has a value for each kind of x axis.
  showFocus(focus) {
    this.quietly(() => {
      for (const { definition, live, u } of this.plots) {
        if (definition.kind === "bins") continue;
        if (!focus) {
          u.setCursor({ left: -10, top: -10 });
          live.replaceChildren();
          continue;
        }
        u.setCursor({ left: u.valToPos(focus.at[definition.kind], "x"), top: 20 });
        live.replaceChildren(...this.model.runs.flatMap((run) => {
          const i = focus.indices[run.index];
          return [swatch(run.index), ` ${definition.read(run, i)} `];
        }), definition.unit);
      }
    });
  }
}

// Of the ticks of a logarithmic axis, the powers of ten.
function decades(u, splits) {
  return splits.map((v) => (Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9 ? v : null));
}

function tickText(v) {
  return (v < 0 ? "\u2212" : "") + String(+Math.abs(v).toPrecision(6));
}

function withAlpha(rgb, alpha) {
  return rgb.replace(/^rgb\(/, "rgba(").replace(/\)$/, `, ${alpha})`);
}

function definitions(model) {
  const all = [
    errorPlot(model, "t", "Contour error over time, \u00b5m", "Time, s"),
    errorPlot(model, "s", "Contour error over arc length, \u00b5m", "Arc length, mm"),
    {
      kind: "t", title: "Feed, mm/min", x: "Time, s", unit: "mm/min",
      data: uPlot.join(model.runs.map((r) => [r.t, r.feed, r.plan])),
      series: model.runs.flatMap((r) => [{ run: r.index }, { run: r.index, width: 1.25, dash: [5, 4], alpha: 0.75 }]),
      read: (r, i) => `${Math.round(r.feed[i])} (plan ${Math.round(r.plan[i])})`,
      range: (u, low, high) => uPlot.rangeNum(Math.min(0, low ?? 0), high ?? 1, 0.1, true),
    },
  ];
  for (let k = 0; k < model.axes; k++) {
    all.push({
      kind: "t", title: `Torque ${"XYZ"[k]}, N m`, x: "Time, s", unit: "N m",
      data: uPlot.join(model.runs.map((r) => [r.t, r.torque[k]])),
      series: model.runs.map((r) => ({ run: r.index, width: 1.25 })),
      levels: [{ value: 0 }], read: (r, i) => formatNumber(r.torque[k][i]),
    });
  }
  const histogram = histogramPlot(model);
  return histogram ? [...all, histogram] : all;
}

function errorPlot(model, kind, title, x) {
  const tables = [], series = [], bands = [];
  for (const run of model.runs) {
    const [xs, columns] = errorColumns(run, run[kind]);
    tables.push([xs, ...columns]);
    if (columns.length > 1) {
      const first = series.length + 1;
      bands.push({ series: [first + 1, first], run: run.index });
      series.push({ run: run.index, edge: true }, { run: run.index, edge: true });
    }
    series.push({ run: run.index });
  }
  const tolerance = model.tolerance_um;
  const levels = [{ value: 0 }];
  if (tolerance) levels.push({ value: tolerance, dash: true });
  if (tolerance && model.axes === 2) levels.push({ value: -tolerance, dash: true });
  return {
    kind, title, x, unit: "\u00b5m", data: uPlot.join(tables), series, bands, levels,
    read: (r, i) => (r.cutting[i] ? formatNumber(r.error_um[i]) : "rapid"),
  };
}

// The error where the tool cuts and gaps elsewhere; for thinned runs with the least and the largest. One value for each
// place on the x axis: over arc length a dwell has many, of which the largest error stays.
function errorColumns(run, places) {
  const xs = [], columns = run.thinned ? [[], [], []] : [[]], last = columns.length - 1;
  for (let i = 0; i < run.n; i++) {
    const cutting = run.cutting[i] > 0;
    const values = (run.thinned ? [run.low_um[i], run.high_um[i], run.error_um[i]] : [run.error_um[i]]);
    const end = xs.length - 1;
    if (end >= 0 && places[i] <= xs[end]) {
      const kept = columns[last][end];
      if (!cutting || (kept !== null && Math.abs(kept) >= Math.abs(run.error_um[i]))) continue;
      values.forEach((v, c) => { columns[c][end] = v; });
      continue;
    }
    xs.push(places[i]);
    values.forEach((v, c) => columns[c].push(cutting ? v : null));
  }
  return [xs, columns];
}

// Shares of the cutting time in bins that all runs have in common.
function histogramPlot(model) {
  const histograms = model.runs.map((r) => r.histogram).filter((h) => h.counts.length);
  if (histograms.length !== model.runs.length) return null;
  const width = Math.max(...histograms.map((h) => h.bin_um));
  const binned = histograms.map((h) => {
    const factor = Math.round(width / h.bin_um), total = h.counts.reduce((a, b) => a + b, 0), bins = new Map();
    h.counts.forEach((count, i) => {
      const bin = Math.floor((h.first_bin + i) / factor);
      bins.set(bin, (bins.get(bin) || 0) + 100 * count / total);
    });
    return bins;
  });
  const keys = binned.flatMap((b) => [...b.keys()]);
  const first = Math.min(...keys) - 1, last = Math.max(...keys) + 1, numbers = [];
  for (let b = first; b <= last; b++) numbers.push(b);
  return {
    kind: "bins", title: "Distribution of the contour error, % of cutting time, logarithmic", x: "Contour error, \u00b5m",
    data: [numbers.map((b) => b * width), ...binned.map((bins) => numbers.map((b) => Math.max(bins.get(b) || 0, LEAST_SHARE / 2)))],
    series: model.runs.map((r) => ({ run: r.index, fill: true })), paths: uPlot.paths.stepped({ align: 1 }),
    logarithmic: true, range: () => [LEAST_SHARE, 100],
  };
}
