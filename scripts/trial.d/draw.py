"""Effects drawn from the catalogue: a kind, a legal place, amounts in a random direction, settings. Whatever is registered takes part."""
import dataclasses, math
from xml.sax.saxutils import quoteattr

from devices import plugins


@dataclasses.dataclass
class Truth:
    effect: str
    location: str
    at: str = ""
    driver: str = ""
    choices: dict = dataclasses.field(default_factory=dict)
    settings: dict = dataclasses.field(default_factory=dict)  # name: (value, unit)
    amounts: dict = dataclasses.field(default_factory=dict)   # name: (value, unit)
    usual: dict = dataclasses.field(default_factory=dict)     # name: usual size
    catalogued: bool = True
    seen: bool = True    # whether it moves anything that is measured
    words: str = ""      # of an effect outside the catalogue: its form
    strength: float = 0  # sigmas per pose that neither geometry nor the other effects take up

    def element(self, scale=1.0, free=False):
        attributes = {"at": self.at, "driver": self.driver, **self.choices}
        text = f"<{self.effect}" + "".join(f" {n}={quoteattr(v)}" for n, v in attributes.items() if v)
        for name, (value, unit) in self.settings.items():
            text += f' {name}="{quantity(value, unit)}"'
        size = math.sqrt(sum((scale * v / self.usual[n]) ** 2 for n, (v, _) in self.amounts.items()))  # in usual sizes
        for name, (value, unit) in self.amounts.items():
            tolerance = 10 * size * self.usual[name] if free else None
            text += f' {name}="{quantity(scale * value, unit, tolerance)}"'
        return text + "/>"

    def scaled(self, scale):
        return dataclasses.replace(self, amounts={n: (scale * v, u) for n, (v, u) in self.amounts.items()})

    def place(self):
        return self.effect, self.location


def quantity(value, unit, tolerance=None):
    text = f"{value:.9g}" + (f" ± {tolerance:.3g}" if tolerance else "")
    return text if unit in ("1", "mm", "deg") else f"{text} {unit}"


def places(plugin, sensors, joints):
    """Where an effect can act: the place as the model file says it, as results call it, and the unit of what it corrects."""
    acts = plugin["acts"]
    whole = {"lengths": "links", "fixture": "fixture"}.get(acts, "measurement")
    if plugin["everywhere"] or acts in ("lengths", "fixture", "tip", "measured"):
        return [("", whole, "")]
    found = []
    if acts == "reading":
        for s in sensors.values():
            joint = next((j.name for j in joints.values() if j.moved_by == s.name), "")
            named = joint if plugin["at_joint"] and s.unit == "deg" and joint else s.name
            found.append((named, named, s.unit, s))
    elif acts == "link":
        found = [(j.link, j.link, j.unit, None) for j in joints.values()]
    else:
        found = [(j.name, j.name, j.unit, None) for j in joints.values()]
    borrowed = [i["name"] for i in plugin["inputs"] if i["role"] == "borrowed"]
    return [f[:3] for f in found if (not plugin["on"] or f[2] in plugin["on"])
            and all(f[3] and b in f[3].inputs for b in borrowed)]


def kinds(sensors, joints):
    """Effects of the catalogue that have a place here; curves of no known cause and formulas told twice are left out."""
    return [p for p in plugins.values() if p["family"] == "effect" and not p["unknown"] and not p["same_as"]
            and places(p, sensors, joints)]


def drawn(draw, sensors, joints, table):
    """One effect; its amounts are of usual size, to be scaled."""
    plugin = draw.choice(kinds(sensors, joints))
    at, location, unit = draw.choice(places(plugin, sensors, joints))
    form = draw.choice(plugin["forms"])
    truth = Truth(plugin["name"], location, at)
    if form["driven"] != "no":
        own = location
        others = [j for j in joints if {"other": j != own, "own": j == own}.get(form["driven"], True)]
        if not others:
            return None
        truth.driver = draw.choice(others)
    truth.choices = {c["name"]: draw.choice(c["words"]) for c in plugin["choices"]}
    inputs = {i["name"]: {**i, **i.get("length", {})} if unit == "mm" else i for i in plugin["inputs"]}
    for name, i in inputs.items():
        if i["role"] == "setting":
            value = setting(plugin, name, i, sensors.get(location), draw, table)
            if value is not None:
                truth.settings[name] = (value, i["unit"])
    weights = [draw.gauss(0, 1) for _ in form["amounts"]]
    norm = math.sqrt(sum(w * w for w in weights))
    for name, weight in zip(form["amounts"], weights):
        i = inputs[name]
        truth.amounts[name] = (i["typical"] * (abs(weight) if i.get("not_negative") else weight) / norm, i["unit"])
        truth.usual[name] = i["typical"]
    return truth


def setting(plugin, name, i, sensor, draw, table):
    """From which pose or session on; one of the values that are to be tried; a reading within the range. None: the default."""
    names, rows = table
    if name == plugin["onset"]:
        column = [row[names.index(name)] for row in rows]
        first, last = min(column), max(column)
        if first == last:
            return None
        return draw.randint(2, int(last)) if name == "session" else draw.randint(int(0.15 * last), int(0.85 * last))
    if i.get("tries"):
        return draw.choice(i["tries"])
    if "length" in i and sensor:
        column = names.index(f"{sensor.inputs.get('column', sensor.name)}[{sensor.unit}]")
        return round(sorted(row[column] for row in rows)[int(draw.uniform(0, 0.6) * len(rows))], 2)
    return None
