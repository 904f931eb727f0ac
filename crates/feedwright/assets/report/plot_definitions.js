// What each plot shows: data, series, how values are told.

// Shares below this many per cent are not drawn: logarithms need an end.
const LEAST_SHARE = 0.01;
// Nor are errors below this part of the largest, on a logarithmic axis.
const LEAST_ERROR = 1e-5;
// The largest error around a point is that of two such parts of the run.
const ENVELOPE_PARTS = 1200;

function definitions(model, state) {
  const all = [
    errorPlot(model, state.log, "t", "Contour error over time", "Time, s"),
    errorPlot(model, state.log, "s", "Contour error over arc length", `Arc length, ${LENGTH_UNIT}`),
    feedPlot(model),
    ...axisPlots(model, "torque", "Torque", "N m", "torque_nm"),
    ...axisPlots(model, "accel", "Command acceleration", "m/s\u00b2", "accel_m_s2"),
  ];
  for (const alone of [state.log ? exceedancePlot(model) : histogramPlot(model), spectrumPlot(model)]) if (alone) all.push(alone);
  return all;
}

function feedPlot(model) {
  return {
    kind: "t", title: `Feed, ${FEED_UNIT}`, x: "Time, s", unit: FEED_UNIT,
    data: uPlot.join(model.runs.map((r) => [r.t, r.feed, r.plan])),
    series: model.runs.flatMap((r) => [{ run: r.index }, { run: r.index, width: 1.25, dash: [5, 4], alpha: 0.75 }]),
    read: (r, i) => `${Math.round(r.feed[i])} (plan ${Math.round(r.plan[i])})`,
    range: (u, low, high) => uPlot.rangeNum(Math.min(0, low ?? 0), high ?? 1, 0.1, true),
  };
}

// What each axis is asked for, beside what it may. A run of a log has none.
function axisPlots(model, column, title, unit, limitName) {
  const runs = model.runs.filter((r) => r[column]);
  return Array.from({ length: runs.length ? model.axes : 0 }, (_, k) => {
    const limit = model.limits[k]?.[limitName], levels = [{ value: 0 }];
    if (limit) levels.push({ value: limit, dash: true }, { value: -limit, dash: true });
    return {
      kind: "t", title: `${title} ${"XYZ"[k]}, ${unit}${limit ? ` \u00b7 limit \u00b1${formatNumber(limit)}` : ""}`, x: "Time, s", unit,
      data: uPlot.join(runs.map((r) => [r.t, r[column][k]])),
      series: runs.map((r) => ({ run: r.index, width: 1.25 })),
      levels, read: (r, i) => (r[column] ? formatNumber(r[column][k][i]) : "\u2013"), range: limitedRange(limit),
    };
  });
}

// Limits further off than this, in sizes of the curve, are told but not drawn: the curve would be flat.
const FAR_LIMIT = 4;

function limitedRange(limit) {
  return (u, low, high) => {
    const size = Math.max(Math.abs(low ?? 0), Math.abs(high ?? 0)), near = limit && limit < FAR_LIMIT * size;
    const [least, most] = near ? [Math.min(low, -limit), Math.max(high, limit)] : [low ?? -1, high ?? 1];
    return uPlot.rangeNum(least, most, 0.1, true);
  };
}

function errorPlot(model, logarithmic, kind, title, x) {
  const tables = [], series = [], bands = [];
  const floor = LEAST_ERROR * Math.max(1e-3, ...model.runs.map((r) => r.max_um));
  for (const run of model.runs) {
    const [xs, columns] = errorColumns(run, run[kind], logarithmic && floor);
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
    kind, title: `${title}, ${ERROR_UNIT}${logarithmic ? ", largest around, logarithmic" : ""}`, x, unit: ERROR_UNIT,
    data: uPlot.join(tables), series, bands, levels, logarithmic,
    range: logarithmic ? (u, low, high) => logarithmicRange(Math.max(low ?? 1, (high ?? 1) * 1e-4), high ?? 1) : undefined,
    read: (r, i) => (r.cutting[i] ? formatError(r.error_um[i]) : "rapid"),
  };
}

// Powers of ten around a range.
function logarithmicRange(low, high) {
  const bottom = 10 ** Math.floor(Math.log10(low) + 1e-9), top = 10 ** Math.ceil(Math.log10(high) - 1e-9);
  return [bottom, top > bottom ? top : 10 * bottom];
}

// The error where the tool cuts and gaps elsewhere; for thinned runs with the least and the largest. With a `floor` its magnitude,
// at least that, the largest of the points around: on a logarithmic axis every passage through zero would be a spike. One value for each place on the x axis: over arc length a dwell has many, of
// which the largest error stays.
function errorColumns(run, places, floor) {
  const banded = run.thinned && !floor;
  const sizes = floor && largestAround(run, Math.ceil(run.n / ENVELOPE_PARTS), floor);
  const xs = [], columns = banded ? [[], [], []] : [[]], last = columns.length - 1;
  for (let i = 0; i < run.n; i++) {
    const cutting = run.cutting[i] > 0;
    const values = banded ? [run.low_um[i], run.high_um[i], run.error_um[i]] : [floor ? sizes[i] : run.error_um[i]];
    const end = xs.length - 1;
    if (end >= 0 && places[i] <= xs[end]) {
      const kept = columns[last][end];
      if (!cutting || (kept !== null && Math.abs(kept) >= Math.abs(values[last]))) continue;
      values.forEach((v, c) => { columns[c][end] = v; });
      continue;
    }
    xs.push(places[i]);
    values.forEach((v, c) => columns[c].push(cutting ? v : null));
  }
  return [xs, columns];
}

// Magnitude of the largest error within so many points on either side, of those that cut.
function largestAround(run, reach, floor) {
  const sizes = run.error_um.map((um, i) => (run.cutting[i] ? Math.abs(um) : 0)), largest = new Float64Array(run.n);
  for (let i = 0; i < run.n; i++) {
    let most = floor;
    for (let k = Math.max(0, i - reach); k <= Math.min(run.n - 1, i + reach); k++) if (sizes[k] > most) most = sizes[k];
    largest[i] = most;
  }
  return largest;
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
    kind: "bins", title: "Distribution of the contour error, % of cutting time, logarithmic", x: `Contour error, ${ERROR_UNIT}`,
    data: [numbers.map((b) => b * width), ...binned.map((bins) => numbers.map((b) => Math.max(bins.get(b) || 0, LEAST_SHARE / 2)))],
    series: model.runs.map((r) => ({ run: r.index, fill: true })), paths: uPlot.paths.stepped({ align: 1 }),
    logarithmic: true, range: () => [LEAST_SHARE, 100],
    read: (share) => `${formatNumber(share < LEAST_SHARE ? 0 : share)} %`, place: (um) => `at ${formatNumber(um)} ${ERROR_UNIT}`,
  };
}

// For how much of the cutting time the error is larger, over its size: what a histogram with one width of bins cannot show of runs
// that differ by orders of magnitude.
function exceedancePlot(model) {
  const tables = model.runs.filter((r) => r.histogram.counts.length).map((r) => exceedance(r.histogram));
  if (tables.length !== model.runs.length) return null;
  return {
    kind: "bins", title: "Time with a larger contour error, % of cutting time, logarithmic", x: `Contour error, ${ERROR_UNIT}, magnitude`,
    data: uPlot.join(tables), series: model.runs.map((r) => ({ run: r.index, spanGaps: true })),
    logarithmic: true, logarithmicX: true, range: () => [LEAST_SHARE, 100],
    read: (share) => (share === null || share === undefined ? "\u2013" : `${formatNumber(share)} %`),
    place: (um) => `above ${formatNumber(um)} ${ERROR_UNIT}`,
  };
}

function exceedance(histogram) {
  const total = histogram.counts.reduce((a, b) => a + b, 0), bySize = new Map();
  histogram.counts.forEach((count, i) => {
    const bin = histogram.first_bin + i, size = bin >= 0 ? bin : -bin - 1;
    bySize.set(size, (bySize.get(size) || 0) + count);
  });
  const sizes = [...bySize.keys()].sort((a, b) => a - b), xs = [], shares = [];
  let above = total;
  for (const size of sizes) {
    if (size > 0 || xs.length) {
      xs.push(Math.max(size, 0.5) * histogram.bin_um);
      shares.push(100 * above / total);
    }
    above -= bySize.get(size);
  }
  xs.push((sizes[sizes.length - 1] + 1) * histogram.bin_um);
  shares.push(LEAST_SHARE / 2);
  return [xs, shares];
}

// RMS of the error in bands of frequency: the squares of all bands add up to that of the whole.
function spectrumPlot(model) {
  const runs = model.runs.filter((r) => r.spectrum.length);
  if (runs.length !== model.runs.length) return null;
  const middle = ([from, to]) => (from > 0 ? Math.sqrt(from * to) : to / 2);
  const largest = Math.max(1e-6, ...runs.flatMap((r) => r.spectrum.map((band) => band[2])));
  return {
    kind: "hz", title: `Spectrum of the contour error, ${ERROR_UNIT} RMS in each band, logarithmic`, x: "Frequency, Hz",
    data: uPlot.join(runs.map((r) => [r.spectrum.map(middle), r.spectrum.map((band) => Math.max(band[2], largest * 1e-7))])),
    series: runs.map((r) => ({ run: r.index, spanGaps: true })),
    logarithmic: true, logarithmicX: true,
    range: (u, low, high) => logarithmicRange(Math.max(low ?? 1, (high ?? 1) * 1e-6), high ?? 1),
    read: (um) => (um === null || um === undefined ? "\u2013" : `${um.toPrecision(2)} ${ERROR_UNIT}`), place: (hz) => `at ${formatNumber(hz)} Hz`,
  };
}
