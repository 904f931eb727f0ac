"""The path of a cut as a picture for notebooks."""

from __future__ import annotations

from typing import Any

#: Colors from no error to the largest, as the report has them.
COLORS = ("#2c7fb8", "#41b6c4", "#c7a500", "#f16913", "#cb181d")
#: Points that are drawn at the most.
MOST_POINTS = 3000
#: Width and height, pixels.
SIZE = 320


def svg(rows: Any) -> str:
    """The tool's path in the XY plane, colored by the magnitude of its error."""
    import numpy

    step = max(1, len(rows["t_s"]) // MOST_POINTS)
    x, y = (rows[f"act_{axis}_mm"][::step] for axis in "xy")
    error = numpy.abs(rows["contour_error_um"][::step])
    if len(x) < 2:
        return ""
    low = numpy.array([x.min(), y.min()])
    span = max(x.max() - low[0], y.max() - low[1], 1e-9)
    across = numpy.round((x - low[0]) / span * (SIZE - 16) + 8, 1)
    down = numpy.round(SIZE - 8 - (y - low[1]) / span * (SIZE - 16), 1)
    largest = max(error.max(), 1e-12)
    shade = numpy.minimum((error / largest * len(COLORS)).astype(int), len(COLORS) - 1)
    ends = numpy.flatnonzero(numpy.diff(shade)) + 1
    lines = []
    for first, last in zip([0, *ends], [*ends, len(x)]):
        points = " ".join(f"{a},{b}" for a, b in zip(across[first : last + 1], down[first : last + 1]))
        lines.append(f'<polyline points="{points}" fill="none" stroke="{COLORS[shade[first]]}" stroke-width="1.5"/>')
    caption = f"Path of the tool, colored by its error from 0 to {largest:.3g} um"
    return (
        f'<svg width="{SIZE}" height="{SIZE}" viewBox="0 0 {SIZE} {SIZE}" role="img" aria-label="{caption}">'
        f"<title>{caption}</title>{''.join(lines)}</svg>"
    )
