// Decodes the data: deflated JSON in base64, in which columns are differences of integers, see crates/feedwright/src/report/embedded_data.rs.

const AXIS_NAMES = ["x", "y", "z"];

// Names of the units of errors, lengths and feedrates. Values named _um and _mm are in these units: one of errors is a thousandth of one of lengths.
let ERROR_UNIT = "\u00b5m", LENGTH_UNIT = "mm", FEED_UNIT = "mm/min";

async function inflated(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).json();
}

export function decode(differences, unit) {
  const values = new Float64Array(differences.length);
  let sum = 0;
  for (let i = 0; i < differences.length; i++) {
    sum += differences[i];
    values[i] = sum * unit;
  }
  return values;
}

function readModel(raw) {
  const u = raw.meta.units, axes = Math.min(3, Math.max(2, raw.meta.axes));
  [ERROR_UNIT, LENGTH_UNIT, FEED_UNIT] = raw.meta.names;
  const zeros = (n) => new Float64Array(n);
  const runs = raw.runs.map((columns, i) => {
    const meta = raw.meta.runs[i], n = columns.t.length;
    const axisColumns = (prefix, unit) =>
      AXIS_NAMES.map((a) => (columns[prefix + a] ? decode(columns[prefix + a], unit) : zeros(n)));
    const error_um = decode(columns.e, meta.error_mm * 1e3);
    return {
      index: i, n, name: meta.controller, worst: meta.worst, spectrum: meta.spectrum, histogram: meta.histogram,
      max_um: meta.max_um, thinned: meta.rows_per_point > 1,
      t: decode(columns.t, u.time_s), s: decode(columns.s, u.length_mm),
      error_um,
      low_um: columns.lo ? decode(columns.lo, meta.error_mm * 1e3) : error_um,
      high_um: columns.hi ? decode(columns.hi, meta.error_mm * 1e3) : error_um,
      plan: decode(columns.plan, u.feed_mm_s * 60), feed: decode(columns.feed, u.feed_mm_s * 60),
      line: decode(columns.line, 1), cutting: decode(columns.cutting, 1),
      foot: axisColumns("f", u.point_mm), deviation: axisColumns("d", meta.error_mm),
      accel: columns.accel_x ? axisColumns("accel_", u.accel_m_s2).slice(0, axes) : null,
      torque: columns.torque_x ? axisColumns("torque_", u.torque_nm).slice(0, axes) : null,
    };
  });
  const outline = raw.outline && {
    points: AXIS_NAMES.map((a) => raw.outline[a] ? decode(raw.outline[a], u.point_mm) : zeros(raw.outline.x.length)),
    cutting: decode(raw.outline.cutting, 1),
  };
  const circles = raw.meta.circles.map((circle) => ({
    ...circle,
    runs: circle.runs.map((run, i) => run && {
      g_um: run.g_um, radial_um: run.radial.map((v) => (v === null ? null : v * raw.meta.runs[i].error_mm * 1e3)),
    }),
  }));
  return { axes, runs, outline, circles, listing: raw.meta.program, limits: raw.meta.limits, tolerance_um: raw.meta.tolerance_um };
}

// Index of the value nearest to x in an increasing array.
function nearestIndex(values, x) {
  let low = 0, high = values.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] < x) low = middle; else high = middle;
  }
  return Math.abs(values[low] - x) <= Math.abs(values[high] - x) ? low : high;
}

function formatNumber(x) {
  const size = Math.abs(x), digits = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size < 0.9995 && ERROR_UNIT === "thou" ? 3 : 2;
  const text = size.toFixed(digits);
  return (x < 0 && Number(text) !== 0 ? "\u2212" : "") + text;
}

// As formatNumber, with two digits of what is smaller than a tenth.
function formatError(x) {
  if (Math.abs(x) >= 0.0995 || x === 0) return formatNumber(x);
  const digits = Math.min(5, 1 - Math.floor(Math.log10(Math.abs(x))));
  return x.toFixed(digits).replace("-", "\u2212");
}

// 1, 2 or 5 times a power of ten, at most x.
function roundStep(x) {
  const power = 10 ** Math.floor(Math.log10(x)), lead = x / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}
