"""The devices that are tried: the shipped model, how its poses are chosen, which circumstances are recorded,
and a true geometry that deviates from the nominal one within the tolerances."""
import dataclasses, math, re
import xml.etree.ElementTree as xml

from command import read, registered, root

plugins = {p["name"]: p for p in registered()}


@dataclasses.dataclass
class Device:
    name: str
    folder: str                      # of models/
    poses: tuple                     # fewest and most
    ranges: dict = dataclasses.field(default_factory=dict)  # of coordinates, where the model states none
    style: str = "free"              # or "fixture": the settings of the shipped recordings
    motion: float = 0                # how often the poses are those of a motion, quickly recorded
    columns: tuple = ("session", "time", "temperature", "approach")
    payload: str = ""
    group: str = ""                  # a column that names groups of rows


DEVICES = {d.name: d for d in (
    Device("isl-fixture", "isl-bonny-2013", (65, 65), style="fixture"),
    Device("isl-free", "isl-bonny-2013", (65, 150), motion=0.25),
    Device("calibration-device", "device-nordquist-2009", (60, 140)),
    Device("ankle", "ankle-storey-2006", (80, 200), {"q1": (-25, 20), "q2": (-15, 15)}, columns=("session", "time")),
    Device("knee", "knee-two-axis", (80, 200), {"q1": (0, 100), "q2": (-20, 20)}, columns=("session", "time")),
    Device("arm", "arm-6r", (80, 200), payload="payload"),
    Device("mount", "mount-altaz", (80, 200), group="star"),
)}


def nominal(device):
    """The shipped model in one file, without how features are probed: the recordings have the features."""
    folder = root / "models" / device.folder
    text = without_comments((folder / "model.xml").read_text(encoding="utf-8"))
    text = re.sub(r'  <include file="([^"]*)"/>\n', lambda m: included(folder / m[1]), text)
    return re.sub(r' probed="[^"]*"', "", text)


def without_comments(text):
    return re.sub(r"<!--.*?-->\n", "", text, flags=re.S)


def included(file):
    text = without_comments(file.read_text(encoding="utf-8"))
    kept = re.findall(r"^ *<(?:frame|point|length|direction|direction_angles|calibrate|plugin)\b.*$", text, flags=re.M)
    return "".join(line + "\n" for line in kept)


def deviating(text, draw):
    """Every `value ± tolerance` becomes a fixed value, off by a normal deviate of a share of the tolerance; where
    triangles must close a smaller share."""
    share = draw.uniform(0.03, 0.12) if "micrometer_triangle" in text else draw.uniform(0.1, 1)

    def moved(m):
        z = max(-2.5, min(2.5, draw.gauss(0, 1)))
        return f'"{float(m[1]) + share * float(m[2]) * z:.8g}"'

    return re.sub(r'"(-?[\d.]+) ± ([\d.]+)"', moved, text)


@dataclasses.dataclass
class Part:
    """A sensor or a joint of the model."""
    name: str
    kind: str
    unit: str            # of the reading, of the coordinate
    inputs: dict
    moved_by: str = ""   # joints: the sensor or unknown
    sense: int = 1
    link: str = ""


def parts(text):
    """Sensors by name, moving joints by name."""
    tree = xml.fromstring(text.split("?>", 1)[-1])
    family = lambda e, f: plugins.get(e.tag, {}).get("family") == f
    sensors = {e.get("name"): Part(e.get("name"), e.tag, plugins[e.tag]["reading"], dict(e.attrib)) for e in tree if family(e, "sensor")}
    movers = list(sensors) + [e.get("name") for e in tree if e.tag == "unknown"]
    joints = {}
    for e in (e for chain in tree if chain.tag == "chain" for e in chain if family(e, "joint")):
        for i in plugins[e.tag]["inputs"]:
            word = re.fullmatch(r"\s*(-?)\s*(\w+)\s*", e.get(i["name"], "")) if i.get("coordinate") else None
            if word and word[2] in movers:
                name = e.get("name")
                link = e.get("link") or ("link" + name[5:] if name.startswith("joint") else name)
                joints[name] = Part(name, e.tag, i["unit"], dict(e.attrib), word[2], -1 if word[1] else 1, link)
    return sensors, joints


def coordinates(device, text):
    """Columns that a table of poses gives: name with unit, range, the joint that moves, its sense."""
    sensors, joints = parts(text)
    joint_of = {j.moved_by: j for j in joints.values()}
    result = []
    for name in list(sensors) or [j.moved_by for j in joints.values()]:
        joint = joint_of[name]
        part = sensors.get(name)
        column = part.inputs.get("column", name) if part else name
        stated = part.inputs.get("range") if part else None
        span = tuple(map(float, stated.split(","))) if stated else device.ranges.get(name, (-60, 60))
        result.append((column, part.unit if part else "deg", span, joint))
    return result


def turn(axis, sensors):
    """Range of the angle (deg) by which a joint turns over the range of its coordinate's column."""
    _, unit, (low, high), joint = axis
    sensor = sensors.get(joint.moved_by)
    of = {n: float(v.split()[0]) for n, v in sensor.inputs.items() if re.match(r"-?[\d.]+( |$)", v)} if sensor else {}

    def angle(reading):
        if unit == "mm":  # the third side of a triangle
            b, c, a = of["bar1"], of["bar2"], reading + of["madj"]
            reading = math.degrees(math.acos(max(-1, min(1, (b * b + c * c - a * a) / (2 * b * c))))) + of.get("offset", 0)
            return joint.sense * reading
        return joint.sense * (reading * of.get("slope", 1) + of.get("intercept", 0))

    return tuple(sorted((angle(low), angle(high))))


def pose_table(device, text, draw):
    """Readings and circumstances, pose by pose: names of columns, rows of numbers. Also whether it is a motion."""
    axes = coordinates(device, text)
    motion = draw.random() < device.motion
    if device.style == "fixture":
        names, rows = read(root / "models" / device.folder / "recordings.csv")
        at = [next(i for i, n in enumerate(names) if n.split("[")[0] == a[0]) for a in axes]
        values = [[float(row[i]) for i in at] for row in rows]
    else:
        count = draw.randint(*device.poses)
        values = moved(axes, count, draw) if motion else [[draw.uniform(*a[2]) for a in axes] for _ in range(count)]
    columns = {"pose": list(range(1, len(values) + 1))}
    columns.update(circumstances(device, axes, values, motion, draw))
    for i, a in enumerate(axes):
        columns[f"{a[0]}[{a[1]}]"] = [row[i] for row in values]
    return list(columns), [list(row) for row in zip(*columns.values())], motion


def moved(axes, count, draw):
    """A smooth motion: three sines of each coordinate."""
    waves = [[(draw.uniform(0.02, 0.25), draw.uniform(0, 6.28), draw.uniform(0.2, 1)) for _ in range(3)] for _ in axes]
    rows = []
    for k in range(count):
        row = []
        for (_, _, (low, high), _), wave in zip(axes, waves):
            total = sum(w[2] for w in wave)
            swing = sum(w[2] * math.sin(w[0] * k + w[1]) for w in wave) / total
            row.append((low + high) / 2 + (high - low) / 2 * swing)
        rows.append(row)
    return rows


def circumstances(device, axes, values, motion, draw):
    """Sessions with pauses, temperature that warms up and wanders, loads, the sense of the last move."""
    count = len(values)
    sessions = 1 if motion else draw.randint(1, 3)
    breaks = sorted(draw.sample(range(count // 6, count - count // 6), sessions - 1))
    step = draw.uniform(0.02, 0.1) if motion else draw.uniform(15, 90)
    warm, tau, wander = draw.uniform(-1, 5), draw.uniform(600, 5400), draw.uniform(0.1, 1)
    time = begun = 0.0
    session, slow, out = 1, 0.0, {"session": [], "time[s]": [], "temperature[degC]": []}
    base = draw.uniform(18, 23)
    for k in range(count):
        if k in breaks:
            time += draw.uniform(1800, 50000)
            session, begun, base = session + 1, time, draw.uniform(18, 23)
        slow = 0.95 * slow + draw.gauss(0, 0.3 * wander)
        out["session"].append(session)
        out["time[s]"].append(round(time, 3))
        out["temperature[degC]"].append(round(base + warm * (1 - math.exp(-(time - begun) / tau)) + slow, 2))
        time += step * (1 if motion else draw.uniform(0.7, 1.5))
    for i, (_, _, _, joint) in enumerate(axes):
        sense, senses = draw.choice((-1, 1)), []
        for k in range(count):
            if k and values[k][i] != values[k - 1][i]:
                sense = joint.sense if values[k][i] > values[k - 1][i] else -joint.sense
            senses.append(sense)
        out[f"approach_{joint.name}"] = senses
    kept = {n: v for n, v in out.items() if re.split(r"[\[_]", n)[0] in device.columns}
    if device.payload:
        masses = [0, draw.uniform(0.5, 1.5), draw.uniform(1.5, 3)]
        kept[f"{device.payload}[kg]"] = [round(draw.choice(masses), 3) for _ in range(count)]
    if device.group:
        kept[device.group] = [1 + k // 2 for k in range(count)]
    return kept
