"""One blind trial: draws the truth, writes recordings and the nominal model into a folder of their own, runs `talus diagnose`
there, and only then compares. A pure function of the seed and the trial's number."""
import dataclasses, math, pathlib, random, shutil, tempfile, time

import command, draw as catalogue, devices, spoil, strange
from compare import compared
from forms import Forms

# Of a hundred trials. What is drawn in each kind.
KINDS = {"nothing": 18, "more noise": 2, "heavy tails": 2, "wandering noise": 3, "blunders": 3, "wrong column": 4,
         "one effect": 36, "two effects": 12, "three effects": 5, "effect and blunders": 4, "unknown": 11}
COUNTS = {"one effect": 1, "two effects": 2, "three effects": 3, "effect and blunders": 1}
MOST = 10                     # times its usual size: larger effects are not drawn
WEAKEST, STRONGEST = 0.5, 25  # sigmas per pose: sizes are drawn between, uniformly in the logarithm
ABSORBED = 0.2                # below so many sigmas per pose nothing is seen; of such effects a quarter is kept


def trial(seed, number, device="", keep=None):
    """The record of one trial. `keep`: a folder in which its files stay."""
    draw = random.Random(f"talus {seed} {number}")
    name = draw.choice(list(devices.DEVICES))
    kind = draw.choices(list(KINDS), list(KINDS.values()))[0]
    folder = pathlib.Path(keep or tempfile.mkdtemp(prefix="trial"))
    folder.mkdir(parents=True, exist_ok=True)
    try:
        return Trial(folder, devices.DEVICES[device or name], kind, draw).record(seed, number)
    finally:
        if not keep:
            shutil.rmtree(folder)


class Trial:
    def __init__(self, folder, device, kind, draw):
        self.folder, self.device, self.kind, self.draw = folder, device, kind, draw
        self.nominal = devices.nominal(device)
        self.sensors, self.joints = devices.parts(self.nominal)
        self.axes = devices.coordinates(device, self.nominal)
        self.true = devices.deviating(self.nominal, draw)
        names, rows, self.motion = devices.pose_table(device, self.nominal, draw)
        self.table = names, rows
        command.write(folder / "poses.csv", names, [[str(v) for v in row] for row in rows])
        held = set(draw.sample(range(len(rows)), round(0.3 * len(rows))))
        if device.group:  # groups stay together
            at = names.index(device.group)
            groups = sorted({row[at] for row in rows})
            out = set(draw.sample(groups, round(0.3 * len(groups))))
            held = {k for k, row in enumerate(rows) if row[at] in out}
        self.use = ["check" if k in held else "fit" for k in range(len(rows))]
        self.fitted = len(rows) - len(held)
        self.seed = draw.randrange(1, 10**6)
        self.lua, self.faulty = "", []
        self.forms = Forms(folder, self.nominal)

    # Recordings

    def simulated(self, truths, file, noise=1.0):
        """Recordings of the key with these effects, circumstances beside them whether needed or not."""
        if self.lua:
            (self.folder / "strange.lua").write_text(self.lua, encoding="utf-8")
        self.forms.write("key.xml", self.true, [t.element() for t in truths], self.lua)
        names, rows = command.simulate(self.folder, "key.xml", "poses.csv", file, self.seed, noise)
        hidden = [f"{a[0]}[{a[1]}]" for a in self.axes if a[3].moved_by not in self.sensors]  # nobody reads these
        known = [n for n in self.table[0] if n not in [*names, *hidden]]
        more = [[str(row[self.table[0].index(n)]) for n in known] for row in self.table[1]]
        return [*names, *known, "use"], [[*row, *m, u] for row, m, u in zip(rows, more, self.use)]

    def left(self, truths, beside=()):
        """Sigmas per pose of these effects' signal, without noise, that neither geometry nor the effects `beside` take up."""
        command.write(self.folder / "quiet.csv", *self.simulated(truths, "raw.csv", 0))
        fit = self.forms.fit("quiet.csv", [t.element(free=True) for t in beside if t.seen], self.lua)
        return math.sqrt(fit["chi2"] / self.fitted)

    # The truth

    def effects(self):
        truths = []
        wanted = COUNTS.get(self.kind, 0)
        for _ in range(60):
            if len(truths) == wanted:
                break
            t = catalogue.drawn(self.draw, self.sensors, self.joints, self.table)
            aim = math.exp(self.draw.uniform(math.log(WEAKEST), math.log(STRONGEST)))
            if t and t.place() not in [o.place() for o in truths] and (t := self.sized(t, aim)):
                if self.left([t]) > ABSORBED or self.draw.random() < 0.25:
                    truths.append(t)
        if self.kind == "unknown":
            for _ in range(20):
                t, self.lua = strange.drawn(self.draw, self.sensors, self.joints, self.axes)
                aim = math.exp(self.draw.uniform(math.log(1), math.log(STRONGEST)))
                if t := self.sized(t, aim):
                    truths = [t]
                    break
                self.lua = ""
        for t in truths:
            t.strength = self.left(truths, [o for o in truths if o is not t])
        return truths

    def sized(self, truth, aim):
        """The effect with a size that leaves `aim` sigmas per pose, or MOST times its usual size; None where it cannot be."""
        try:
            unit = self.left([truth])
            if unit < 1e-4:
                return dataclasses.replace(truth.scaled(MOST), seen=False)
            size = 1.0
            for _ in range(6):  # strong effects are not proportional
                size = min(MOST, size * aim / unit)
                unit = self.left([truth.scaled(size)])
                if unit < 1e-4 or abs(math.log(unit / aim)) < 0.2 or (size == MOST and unit < aim):
                    break
            return truth.scaled(size) if unit < 1.5 * aim else None
        except command.Refused:
            return None

    def spoiled(self, truths):
        """The recordings to be diagnosed, what else is wrong with them, and which rows are simply bad."""
        noise = self.draw.uniform(1.5, 3) if self.kind == "more noise" else 1.0
        table = self.simulated(truths, "raw.csv", noise)
        if self.kind == "more noise":
            return table, f"{noise:.2f} times the stated noise", []
        if self.kind == "wandering noise":
            return *spoil.wandering(self.simulated(truths, "raw.csv", 0), table, self.draw), []
        if self.kind == "heavy tails":
            table, rows = spoil.mixed(table, self.simulated(truths, "raw.csv", 4), self.draw.uniform(0.05, 0.15), self.draw)
            return table, f"{len(rows)} rows with 4 times the noise", []
        if "blunders" in self.kind:
            times = math.exp(self.draw.uniform(math.log(30), math.log(300)))
            table, rows = spoil.mixed(table, self.simulated(truths, "raw.csv", times), self.draw.randint(1, 4), self.draw)
            return table, f"rows with {times:.0f} times the noise", rows
        if self.kind == "wrong column":
            names = [f"{a[0]}[{a[1]}]" for a in self.axes] if self.sensors else [n for n in table[0] if n.endswith("[mm]")]
            table, what, where = spoil.wrong_column(table, names, self.draw)
            self.faulty = [what, *where, *(a[3].moved_by for a in self.axes if f"{a[0]}[{a[1]}]" in where)]
            return table, f"{what} {', '.join(where)}", []
        return table, "", []

    # The trial

    def record(self, seed, number):
        begun = time.monotonic()
        truths = self.effects()
        (names, rows), wrong, bad = self.spoiled(truths)
        box = self.folder / "box"  # all that the diagnosis sees
        box.mkdir(exist_ok=True)
        command.write(box / "recordings.csv", names, rows)
        (box / "nominal.xml").write_text(self.nominal, encoding="utf-8")
        seconds = command.timed(box, "found.txt", "diagnose", "nominal.xml", "recordings.csv", "--threads", 1, "--next-count", 0,
                                "--details", "--out", ".", "--json", "found.json")
        found = command.load(box / "found.json")
        command.write(self.folder / "sound.csv", names, [r for k, r in enumerate(rows) if k not in bad])
        facts = compared(self, truths, found, bad)
        key = [{**dataclasses.asdict(t), "element": t.element()} for t in truths]
        return {"seed": seed, "trial": number, "device": self.device.name, "kind": self.kind, "poses": len(rows),
                "motion": self.motion, "truths": key, "wrong": wrong, "faulty": self.faulty, "bad": [k + 1 for k in bad], **facts,
                "seconds": round(seconds, 2), "all_seconds": round(time.monotonic() - begun, 2)}
