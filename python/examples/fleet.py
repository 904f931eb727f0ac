"""Which machine holds a tolerance on which part, and in what time: every program on every machine of a fleet.

    python python/examples/fleet.py 'parts/*.ngc' --machines tnv40 workshop mine.toml --tolerance-um 10

Prints a row for each part, with the cutting times of the machines that hold the tolerance, and what the sweep costs for a
whole fleet. Results stay in the folder `fleet`: another run computes what is missing.
"""

import argparse
import glob
import itertools
import sys
import time

import feedwright

#: The fleet that the cost is told for.
PROGRAMS, MACHINES = 1000, 20


def asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", help="paths or patterns")
    parser.add_argument("--machines", nargs="+", default=feedwright.machines())
    parser.add_argument("--tolerance-um", type=float, default=10.0)
    parser.add_argument("--controller", help="by default one that identifies the machine")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--out", default="fleet")
    parser.add_argument("--scheduler", help="address of a scheduler of Dask")
    return parser.parse_args()


def main() -> None:
    args = asked()
    programs = sorted(itertools.chain.from_iterable(map(glob.glob, args.programs)))
    pairs = itertools.product(programs, args.machines)
    jobs = [feedwright.Job(part, on, args.controller, tolerance_um=args.tolerance_um) for part, on in pairs]
    client = None
    if args.scheduler:
        from distributed import Client

        client = Client(args.scheduler)
    begun = time.monotonic()
    swept = feedwright.sweep(jobs, args.out, client=client, workers=args.workers, progress=sys.stderr.isatty())
    took_s = time.monotonic() - begun
    # The folder may have results of other sweeps.
    addresses = {job.address for job in jobs}
    table = feedwright.merge(args.out)
    rows = [dict(zip(table, row)) for row in zip(*table.values())]
    rows = [row for row in rows if row["address"] in addresses]
    for part, of_part in itertools.groupby(rows, key=lambda row: row["program"]):
        held = sorted((row["time_s"], row["machine"]) for row in of_part if row["within_tolerance"])
        told = ", ".join(f"{machine} {time_s:.1f} s" for time_s, machine in held)
        print(f"{part}: {told or 'no machine holds ' + str(args.tolerance_um) + ' um'}")
    errors = sum(row["error"] is not None for row in rows)
    print(f"{len(rows)} jobs, {errors} with mistakes; {swept.computed} computed in {took_s:.1f} s")
    if swept.computed:
        hours = took_s / swept.computed * PROGRAMS * MACHINES / 3600
        print(f"{PROGRAMS} such programs on {MACHINES} machines take {hours:.1f} h on this computer")


if __name__ == "__main__":
    main()
