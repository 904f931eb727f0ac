#!/usr/bin/env python3
"""Expands the lathe cycles of Fanuc by hand: what crates/gcode/tests/oracle_data/lathe_cycles.json was made by.

    lathe_cycles.py > ../oracle_data/lathe_cycles.json

Written from the rules in the operator's manuals (G-code system A), with no code of the reader. Points are (diameter X, Z) as in programs
and become (radius, Z) in mm at the end; a motion is ["rapid" | "feed", x, z].

G90  rapid to (X + 2 R, start), feed to (X, Z), feed to (start, Z), rapid to the start; R the taper as a radius.
G94  the same with X and Z exchanged. G92 as G90, but its way out is a rapid.
G71  start, profile and all depths are first moved by (U, W). Level n lies n times the depth below the start; infeed as the first block of the
     profile moves (G0 or G1), cut to the profile, off at 45 degrees by R, back; at last along the profile, and back to the start.
G72  the same with X and Z exchanged. G73 the profile, moved by U/2 + i (d-n)/(d-1) and so along Z.
G74  pecks of Q along Z, back by R after each, steps of P along X; G75 with X and Z exchanged. P and Q in micrometres.
G76  pass n at depth Q sqrt(n), but at least Qmin deeper than the last, down to the height less the allowance; then the finishing passes. It
     begins depth tan(a/2) ahead, and runs out at 45 degrees over r/10 leads.
"""
import json
import math

CASES = []


def case(name, program, motions):
    """Motions in diameters; those that go nowhere are none."""
    here, kept = None, []
    for kind, x, z in motions:
        point = (0.5 * x, z)
        if here is None or math.dist(here, point) > 0:
            kept.append([kind, *point])
        here = point
    CASES.append({"name": name, "program": program, "motions": kept})


def rapid(x, z):
    return ("rapid", x, z)


def feed(x, z):
    return ("feed", x, z)


HEAD = "O0001\nG21 G40 G97 G99\nT0101\nS800 M3\n"


def program(*lines, end="M30"):
    return HEAD + "\n".join(lines) + f"\n{end}\n"


# One block.

def turning(start, ends, retreat="feed", taper=0.0):
    (xs, zs), out = start, []
    for x, z in ends:
        out += [rapid(x + 2 * taper, zs), feed(x, z), (retreat, xs, z), rapid(xs, zs)]
    return out


def facing(start, ends, taper=0.0):
    (xs, zs), out = start, []
    for x, z in ends:
        out += [rapid(xs, z + taper), feed(x, z), feed(x, zs), rapid(xs, zs)]
    return out


S = (52.0, 2.0)
case("G90 straight, modal", program("G0 X52. Z2.", "G90 X48. Z-30. F0.2", "X44.", "X40. Z-25."),
     [rapid(*S)] + turning(S, [(48, -30), (44, -30), (40, -25)]))
case("G90 taper, distances", program("G0 X52. Z2.", "G90 U-4. W-32. R-3. F0.2", "U-8.", "U-12."),
     [rapid(*S)] + turning(S, [(48, -30), (44, -30), (40, -30)], taper=-3.0))
case("G94 facing", program("G0 X52. Z2.", "G94 X10. Z-2. F0.1", "Z-4.", "Z-6. R-1.5"),
     [rapid(*S)] + facing(S, [(10, -2), (10, -4)]) + facing(S, [(10, -6)], taper=-1.5))
S = (32.0, 5.0)
case("G92 thread of four passes", program("G0 X32. Z5.", "G92 X29.4 Z-30. F1.5", "X28.9", "X28.5", "X28.38"),
     [rapid(*S)] + turning(S, [(29.4, -30), (28.9, -30), (28.5, -30), (28.38, -30)], retreat="rapid"))
case("G92 tapered", program("G0 X32. Z5.", "G92 X29. Z-20. R-0.78 F1.814"),
     [rapid(*S)] + turning(S, [(29, -20)], retreat="rapid", taper=-0.78))


# G71, G72: a profile as straight strokes and quarter arcs, monotonous. Swapped coordinates make G72 of G71.

def crossing(profile, level, deeper):
    """Along where a stroke first reaches a level; None where it does not."""
    for (x0, z0), (x1, z1, *arc) in zip(profile, profile[1:]):
        p0, p1 = (x0, z0), (x1, z1)
        d0, d1 = deeper(p0), deeper(p1)
        if d1 < level - 1e-12:
            continue
        if d0 >= level - 1e-12:
            return p0
        if arc:
            (cx, cz), sign = arc[0], arc[1]
            radius = math.hypot(0.5 * (x0 - cx), z0 - cz)
            return ("arc", (cx, cz), radius, sign)
        t = (level - d0) / (d1 - d0)
        return (x0 + t * (x1 - x0), z0 + t * (z1 - z0))
    return profile[-1][:2]


def rough_g71(start, entry_kind, profile, depth, escape, u, w, outward=1):
    """`profile` from the end of the first block on; a stroke may have ((centre), sign) of an arc: sign of z - centre where it is cut."""
    sx, sz = start[0] + u, start[1] + w
    moved = [(x + u, z + w, *([((a[0][0] + u, a[0][1] + w), a[1])] if a else [])) for x, z, *a in profile]
    moved = [(x, z, *(a[0] if a else ())) for x, z, *a in moved]
    strokes = [(x, z) if not a else (x, z, a[0], a[1]) for x, z, *a in moved]
    entry = strokes[0]
    out, n = [rapid(sx, sz)], 1
    while True:
        x = sx - outward * 2 * n * depth
        if outward * (x - entry[0]) <= 1e-9:
            break
        hit = crossing([s[:2] if len(s) == 2 else s for s in strokes], outward * x, lambda p: outward * p[0]) \
            if all(len(s) == 2 for s in strokes) else crossing_arcs(strokes, x, outward)
        if hit[0] == "arc":
            (cx, cz), radius, sign = hit[1], hit[2], hit[3]
            z = cz + sign * math.sqrt(radius ** 2 - (0.5 * (x - cx)) ** 2)
        else:
            z = hit[1]
        off = min(escape, sz - z)
        out += [(entry_kind, x, sz), feed(x, z), rapid(x + outward * 2 * off, z + off), rapid(x + outward * 2 * off, sz)]
        n += 1
    out += [rapid(sx, sz), (entry_kind, entry[0], entry[1])] + [feed(s[0], s[1]) for s in strokes[1:]]
    return out + [rapid(*start)]


def crossing_arcs(strokes, x, outward):
    points = [(s[0], s[1]) for s in strokes]
    for before, stroke in zip(points, strokes[1:]):
        if outward * (stroke[0] - x) < -1e-12:
            continue
        if outward * (before[0] - x) >= -1e-12:
            return before
        if len(stroke) > 2:
            cx, cz = stroke[2]
            return ("arc", (cx, cz), math.hypot(0.5 * (before[0] - cx), before[1] - cz), stroke[3])
        t = (x - before[0]) / (stroke[0] - before[0])
        return (x, before[1] + t * (stroke[1] - before[1]))
    return points[-1]


S = (82.0, 2.0)
PROFILE = [(20, 2), (20, -15), (26, -18), (40, -18), (60, -45), (60, -55), (82, -55)]
BLOCKS = ["N100 G0 X20.", "G1 Z-15.", "X26. Z-18.", "X40.", "X60. Z-45.", "W-10.", "N200 X82."]
finish = [rapid(20, 2), feed(20, -15), feed(26, -18), feed(40, -18), feed(60, -45), feed(60, -55), feed(82, -55), rapid(*S)]
roughed = rough_g71(S, "rapid", PROFILE, 4.0, 0.5, 0.4, 0.1)
case("G71 and G70", program("G0 X82. Z2.", "G71 U4. R0.5", "G71 P100 Q200 U0.4 W0.1 F0.3", *BLOCKS, "G70 P100 Q200 F0.15"),
     [rapid(*S)] + roughed + finish)
case("G71 in one block, depth in micrometres", program("G0 X82. Z2.", "G71 P100 Q200 U0.4 W0.1 D4000 F0.3", *BLOCKS),
     [rapid(*S)] + roughed)
case("G71, infeed as G1 and no allowance", program("G0 X82. Z2.", "G71 U7. R1.", "G71 P100 Q200 F0.3", "N100 G1 X20.", *BLOCKS[1:]),
     [rapid(*S)] + rough_g71(S, "feed", PROFILE, 7.0, 1.0, 0.0, 0.0))
ARCS = [(20, 2), (20, -15), (30, -20, (30, -15), -1), (50, -20), (60, -25, (50, -25), 1), (60, -40), (82, -40)]
case("G71 with arcs", program("G0 X82. Z2.", "G71 U3. R0.5", "G71 P1 Q2 U0.6 W0.2 F0.3", "N1 G0 X20.", "G1 Z-15.", "G2 X30. Z-20. R5.",
                              "G1 X50.", "G3 X60. Z-25. R5.", "G1 Z-40.", "N2 X82."),
     [rapid(*S)] + rough_g71(S, "rapid", ARCS, 3.0, 0.5, 0.6, 0.2))
B = (18.0, 2.0)
BORE = [(60, 2), (60, -10), (40, -20), (40, -40), (18, -40)]
case("G71 boring", program("G0 X18. Z2.", "G71 U3. R0.4", "G71 P1 Q2 U-0.4 W0.1 F0.2", "N1 G0 X60.", "G1 Z-10.", "X40. Z-20.", "Z-40.", "N2 X18."),
     [rapid(*B)] + rough_g71(B, "rapid", BORE, 3.0, 0.4, -0.4, 0.1, outward=-1))


def rough_g72(start, entry_kind, profile, depth, escape, u, w):
    sx, sz = start[0] + u, start[1] + w
    strokes = [(x + u, z + w) for x, z in profile]
    out, n = [rapid(sx, sz)], 1
    while True:
        z = sz - n * depth
        if z <= strokes[0][1] + 1e-9:
            break
        hit = crossing(strokes, z, lambda p: p[1])
        off = min(escape, 0.5 * (sx - hit[0]))
        out += [(entry_kind, sx, z), feed(hit[0], z), rapid(hit[0] + 2 * off, z + off), rapid(sx, z + off)]
        n += 1
    return out + [rapid(sx, sz), (entry_kind, *strokes[0])] + [feed(*s) for s in strokes[1:]] + [rapid(*start)]


FACE = [(82, -30), (50, -30), (40, -20), (40, -12), (20, -2), (20, 2)]
case("G72", program("G0 X82. Z2.", "G72 W3. R0.6", "G72 P10 Q20 U0.4 W0.2 F0.25", "N10 G0 Z-30.", "G1 X50.", "X40. Z-20.", "Z-12.", "X20. Z-2.", "N20 Z2."),
     [rapid(*S)] + rough_g72(S, "rapid", FACE, 3.0, 0.6, 0.4, 0.2))


def pattern(start, profile, shift, passes, u, w):
    out = []
    for n in range(passes):
        share = (passes - 1 - n) / (passes - 1) if passes > 1 else 0.0
        dx, dz = 2 * shift[0] * share + u, shift[1] * share + w
        out.append(rapid(start[0] + dx, start[1] + dz))
        out += [(kind, x + dx, z + dz) for kind, x, z in profile]
    return out + [rapid(*start)]


case("G73", program("G0 X82. Z2.", "G73 U9. W3. R4", "G73 P100 Q200 U0.4 W0.1 F0.3", *BLOCKS),
     [rapid(*S)] + pattern(S, [rapid(20, 2)] + [feed(*p) for p in PROFILE[1:]], (18.0 / 2, 3.0), 4, 0.4, 0.1))


def pecks(start, end, step, back):
    """Depths of one groove, along one coordinate."""
    sense, out, n = math.copysign(1, end - start), [], 1
    while n * step < abs(end - start) - 1e-9:
        out += [("feed", start + sense * n * step), ("rapid", start + sense * (n * step - back))]
        n += 1
    return out + [("feed", end)]


def places(start, end, step):
    count = math.ceil(abs(end - start) / step - 1e-9) if step else 0
    return [start + math.copysign(1, end - start) * n * step for n in range(count)] + [end]


def grooves(start, end, along_z, peck, step, back, relief=0.0):
    out = []
    cross = places(start[0], end[0], 2 * step) if along_z else places(start[1], end[1], step)
    for place in cross:
        aside = -math.copysign(1, end[0] - start[0]) if along_z else -math.copysign(1, end[1] - start[1])
        if along_z:
            out.append(rapid(place, start[1]))
            out += [(kind, place, z) for kind, z in pecks(start[1], end[1], peck, back)]
            if relief:
                out.append(rapid(place + aside * 2 * relief, end[1]))
            out.append(rapid(place + aside * 2 * relief, start[1]))
        else:
            out.append(rapid(start[0], place))
            out += [(kind, 2 * r, place) for kind, r in pecks(0.5 * start[0], 0.5 * end[0], peck, back)]
            if relief:
                out.append(rapid(end[0], place + aside * relief))
            out.append(rapid(start[0], place + aside * relief))
    return out + [rapid(*start)]


S = (40.0, 3.0)
case("G74 grooves in a face", program("G0 X40. Z3.", "G74 R0.5", "G74 X28. Z-12. P2500 Q4000 F0.08"),
     [rapid(*S)] + grooves(S, (28, -12), True, 4.0, 2.5, 0.5))
D = (0.0, 3.0)
case("G74 drilling", program("G0 X0 Z3.", "G74 R1.", "G74 Z-50. Q10000 F0.1"),
     [rapid(*D)] + [(k, 0.0, z) for k, z in pecks(3.0, -50.0, 10.0, 1.0)] + [rapid(*D)])
S = (42.0, -10.0)
case("G75 grooves with relief", program("G0 X42. Z-10.", "G75 R0.3", "G75 X30. Z-22. P2500 Q4000 R0.2 F0.06"),
     [rapid(*S)] + grooves(S, (30, -22), False, 2.5, 4.0, 0.3, relief=0.2))


def thread(start, end, height, first, least, allowance, finishing, run_out, angle, taper=0.0):
    outward, ahead = math.copysign(1, start[0] - end[0]), math.copysign(1, end[1] - start[1])
    depths, depth, n = [], 0.0, 0
    while depth < height - allowance - 1e-9:
        n += 1
        depth = min(max(first * math.sqrt(n), depth + least), height - allowance)
        depths.append(depth)
    depths += [height] * finishing
    out = []
    for depth in depths:
        begin = start[1] + ahead * depth * math.tan(math.radians(angle / 2))

        def x(z):
            return end[0] + outward * 2 * (height - depth) + 2 * taper * (z - end[1]) / (start[1] - end[1])

        leave = end[1] - ahead * run_out
        out += [rapid(start[0], begin), rapid(x(begin), begin), feed(x(leave), leave)]
        off = min(run_out, 0.5 * outward * (start[0] - x(leave))) if run_out else 0.0
        if run_out:
            out.append(feed(x(leave) + outward * 2 * off, leave + ahead * off))
        out.append(rapid(start[0], leave + ahead * off))
    return out + [rapid(*start)]


S = (32.0, 6.0)
case("G76", program("G0 X32. Z6.", "G76 P021060 Q100 R0.05", "G76 X27.4 Z-30. P1300 Q400 F2."),
     [rapid(*S)] + thread(S, (27.4, -30), 1.3, 0.4, 0.1, 0.05, 2, 2.0, 60))
case("G76 tapered, no run-out", program("G0 X32. Z6.", "G76 P010055 Q80 R0.04", "G76 X26. Z-20. R-0.8 P1162 Q350 F1.814"),
     [rapid(*S)] + thread(S, (26, -20), 1.162, 0.35, 0.08, 0.04, 1, 0.0, 55, taper=-0.8))
case("G76 in one block", program("G0 X32. Z6.", "G76 X27.4 Z-30. K1.3 D0.4 F2. A60"),
     [rapid(*S)] + thread(S, (27.4, -30), 1.3, 0.4, 0.0, 0.0, 0, 0.0, 60))
I = (26.0, 5.0)
case("G76 inside", program("G0 X26. Z5.", "G76 P020500 Q100 R0.05", "G76 X30. Z-20. P1100 Q300 F1.5"),
     [rapid(*I)] + thread(I, (30, -20), 1.1, 0.3, 0.1, 0.05, 2, 0.75, 0))

print(json.dumps(CASES, indent=1))
