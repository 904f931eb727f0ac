"""python/gym_peers.py: what other controllers come to in the public round of the gym, for the package: _peers.json on stdout.

Needs a module that is built with the feature `peers`; `just gym-peers` does both. The parameters of a controller are
searched on each machine as the laboratory does it, on its own parts and with the noise of the machine file, which no cut
of the round has. Those that practice on the part first, and those that are not fit for a servo thread, are left out.
"""

import functools
import json
import sys

from feedwright import FeedwrightError, _feedwright, lab

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
)

results = []
for name in (*LIBRARY, *PEERS):
    try:
        result = lab.benchmark(name, settings=functools.partial(_feedwright.searched_settings, name)).results
    except FeedwrightError as error:
        print(f"{name}: {error}", file=sys.stderr)
        continue
    print(name, result["scores"], file=sys.stderr)
    results.append({key: value for key, value in result.items() if key != "rows"})
json.dump(results, sys.stdout, indent=1, allow_nan=False)
print()
