// The curves, drawn by uPlot: every plot has all runs that are shown, plots over the same quantity share cursor and range.

const PLOT_HEIGHT = 180;

class Plots {
  // `beside` takes the plot that has no place along the path.
  constructor(model, state, container, beside, actions) {
    Object.assign(this, { model, state, actions, busy: false });
    this.plots = definitions(model, state).map((definition) => {
      const alone = definition.kind !== "t" && definition.kind !== "s";
      const figure = (alone ? beside : container).appendChild(document.createElement("figure"));
      figure.className = "plot";
      const caption = figure.appendChild(document.createElement("figcaption"));
      const title = caption.appendChild(document.createElement("b"));
      const live = caption.appendChild(document.createElement("span"));
      live.className = "live";
      const body = figure.appendChild(document.createElement("div"));
      body.className = "plot-body";
      body.tabIndex = 0;
      body.setAttribute("role", "img");
      const plot = { definition, title, live, body, u: null };
      body.addEventListener("keydown", (event) => this.key(plot, event));
      return plot;
    });
    this.build();
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(container);
    observer.observe(beside);
  }

  // Makes the charts anew, in the colours of the theme, with the runs and the error axis that are chosen.
  build() {
    const anew = definitions(this.model, this.state);
    this.plots.forEach((plot, k) => {
      plot.definition = anew[k];
      plot.title.textContent = plot.definition.title;
      plot.body.setAttribute("aria-label",
        `${plot.definition.title}. Arrows move the place, plus and minus zoom, with Shift upwards, 0 shows all.`);
      const range = plot.u && [plot.u.scales.x.min, plot.u.scales.x.max];
      if (plot.u) plot.u.destroy();
      plot.u = new uPlot(this.options(plot), plot.definition.data, plot.body);
      if (range && this.places(plot) && Number.isFinite(range[0])) this.quietly(() => plot.u.setScale("x", { min: range[0], max: range[1] }));
    });
    this.settle();
  }

  // Arrows move the place that all drawings show, plus and minus zoom about it, with Shift across.
  key(plot, event) {
    const { u } = plot, zoom = { "+": 0.8, "=": 0.8, "*": 0.8, "-": 1.25, _: 1.25 }[event.key];
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key], { min, max } = u.scales.x;
    const middle = u.cursor.left > 0 ? u.posToVal(u.cursor.left, "x") : (min + max) / 2;
    if (event.key === "0") u.setData(u.data, true);
    else if (zoom && event.shiftKey) zoomAbout(u, "y", zoom, (u.scales.y.min + u.scales.y.max) / 2);
    else if (zoom) zoomAbout(u, "x", zoom, middle);
    else if (way && this.places(plot)) this.actions.focus(plot.definition.kind, middle + way * (max - min) / 100);
    else if (way) u.setCursor({ left: u.cursor.left < 0 ? 0 : u.cursor.left + 5 * way, top: 20 });
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  places(plot) {
    return plot.definition.kind === "t" || plot.definition.kind === "s";
  }

  resize() {
    for (const plot of this.plots) {
      const width = plot.body.clientWidth;
      if (width <= 0 || width === plot.u.width) continue;
      plot.u.setSize({ width, height: PLOT_HEIGHT });
      this.settle();
    }
  }

  // Charts that were made or resized are drawn in the next frame; what they report until then is no place that anybody chose.
  settle() {
    this.busy = true;
    cancelAnimationFrame(this.settling);
    this.settling = requestAnimationFrame(() => {
      this.busy = false;
      this.actions.refresh();
    });
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
      width: Math.max(200, plot.body.clientWidth), height: PLOT_HEIGHT, padding: [10, 16, 0, 0],
      legend: { show: false },
      scales: {
        x: { time: false, distr: definition.logarithmicX ? 3 : 1 },
        y: { range: definition.range, distr: definition.logarithmic ? 3 : 1 },
      },
      axes: [
        { ...axis, label: definition.x, size: 26, values, space: 60, filter: definition.logarithmicX ? decades : undefined },
        { ...axis, size: 50, values, space: 28, filter: definition.logarithmic ? decades : undefined },
      ],
      series: [{}, ...definition.series.map((s) => ({
        stroke: s.run === undefined ? "transparent" : runColor(s.run) , width: s.width ?? 1.5, dash: s.dash,
        alpha: s.alpha ?? 1, points: { show: false }, paths: definition.paths, spanGaps: s.spanGaps,
        fill: s.fill ? withAlpha(runColor(s.run), 0.18) : undefined, show: !this.state.hidden.has(s.run),
        ...(s.edge ? { stroke: "transparent", width: 0 } : {}),
      }))],
      bands: definition.bands?.filter((b) => !this.state.hidden.has(b.run)).map((b) => ({ series: b.series, fill: withAlpha(runColor(b.run), 0.28) })),
      cursor: {
        y: false, drag: { x: true, y: true, uni: 24, dist: 5, setScale: true },
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
      return this.places(plot) ? this.actions.unfocus() : undefined;
    }
    if (this.places(plot)) return this.actions.focus(kind, u.posToVal(left, "x"));
    const i = u.cursor.idx;
    if (i === null || i === undefined) return;
    plot.live.replaceChildren(...this.shown().flatMap((run) =>
      [swatch(run.index), ` ${plot.definition.read(u.data[run.index + 1][i])} `]), plot.definition.place(u.data[0][i]));
  }

  shown() {
    return this.model.runs.filter((run) => !this.state.hidden.has(run.index));
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
        if (definition.kind !== "t" && definition.kind !== "s") continue;
        if (!focus) {
          u.setCursor({ left: -10, top: -10 });
          live.replaceChildren();
          continue;
        }
        u.setCursor({ left: u.valToPos(focus.at[definition.kind], "x"), top: 20 });
        live.replaceChildren(...this.shown().flatMap((run) => {
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

function zoomAbout(u, key, factor, middle) {
  const { min, max } = u.scales[key];
  u.setScale(key, { min: middle + (min - middle) * factor, max: middle + (max - middle) * factor });
}

function tickText(v) {
  return (v < 0 ? "\u2212" : "") + String(+Math.abs(v).toPrecision(6));
}

function withAlpha(rgb, alpha) {
  return rgb.replace(/^rgb\(/, "rgba(").replace(/\)$/, `, ${alpha})`);
}
