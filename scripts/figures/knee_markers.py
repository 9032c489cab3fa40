"""Skin markers of the step-up recording as cameras see them: in a frame laid through the thigh's markers, nothing known of the bones."""
import csv, math

THIGH, SHANK = [f"thigh_M0{i}" for i in range(1, 7)], [f"shank_M0{i}" for i in range(1, 5)]


def turned(q, v):
    w, u = q[0], q[1:]
    t = [2 * c for c in cross(u, v)]
    return [a + w * b + c for a, b, c in zip(v, t, cross(u, t))]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    size = math.sqrt(sum(c * c for c in a))
    return [c / size for c in a]


def mean(points):
    return [sum(c) / len(points) for c in zip(*points)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def markers(source, target, frames_of_block):
    """Each marker is given in its bone's frame: taken to the laboratory, then to the cluster's own frame. Blocks: so many frames."""
    with open(source, encoding="utf-8") as f:
        rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
    out = []
    for row in rows:
        point = lambda name: [float(row[f"{name}.{a}[mm]"]) for a in "xyz"]
        turn = lambda name: [float(row[f"{name}.q{a}"]) for a in "wxyz"]
        # The thigh bone's frame is as good a laboratory as any: the cluster's frame takes its place.
        at = {m: point(m) for m in THIGH}
        at.update({m: [a + b for a, b in zip(turned(turn("shank"), point(m)), point("shank"))] for m in SHANK})
        one, two, three, four, _, six = (at[m] for m in THIGH)
        z = unit(minus(mean([one, four]), mean([two, six])))
        x = unit(cross(minus(mean([three, six]), mean([one, two])), z))
        axes, origin = (x, cross(z, x), z), mean([at[m] for m in THIGH])
        new = {"pose": row["pose"], "time[s]": row["time[s]"], "block": int(row["pose"]) // frames_of_block}
        for m in THIGH + SHANK:
            off = minus(at[m], origin)
            for a, axis in zip("xyz", axes):
                new[f"{m}.{a}[mm]"] = f"{sum(p * q for p, q in zip(off, axis)):.4f}"
        out.append(new)
    with open(target, "w", encoding="utf-8", newline="") as f:
        table = csv.DictWriter(f, list(out[0]))
        table.writeheader()
        table.writerows(out)
