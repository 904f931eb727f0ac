"""python/gym_peers.py: what other controllers come to in the public round of the gym, for the package: _peers.json on stdout.

Needs a module that is built with the feature `peers`; `just gym-peers` does both. Controllers have the values that are
their defaults. Those that practice on the part first, and those that are not fit for a servo
thread, are left out.
"""

import json
import sys

from feedwright import FeedwrightError, lab

LIBRARY = ("uncorrected", "feedforward", "magnitude-only", "two-dimensional", "lqg-identified")
PEERS = (
    "cross-coupled",
    "contour-compensation",
    "fuzzy-feedrate",
    "fuzzy-h-infinity",
    "cross-coupled-feedrate",
    "corner-contour",
    "feedforward-as-delivered",
    "feedforward-cross-coupled",
    "input-shaping",
    "zero-phase",
    "zero-phase-friction",
    "disturbance-observer",
    "kalman-disturbance",
    "receding-horizon",
)

results = []
for name in (*LIBRARY, *PEERS):
    try:
        result = lab.benchmark(name).results
    except FeedwrightError as error:
        print(f"{name}: {error}", file=sys.stderr)
        continue
    print(name, result["scores"], file=sys.stderr)
    results.append({key: value for key, value in result.items() if key != "rows"})
json.dump(results, sys.stdout, indent=1, allow_nan=False)
print()
