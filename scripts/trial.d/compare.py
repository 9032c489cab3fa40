"""Opens the key: which finding is which truth, which claim explains the recordings as well under another name, and what could have been attained."""
import math, re
import xml.etree.ElementTree as xml

import command
from devices import plugins

TWIN = 9  # chi-square by which a claim may be worse than the truth and still explain the recordings as well


def compared(trial, truths, found, bad):
    """What is kept of a trial: plain facts, to be judged later."""
    same = {p["name"]: p["same_as"] or p["name"] for p in plugins.values() if p["family"] == "effect"}
    claims = [{"effect": same.get(f["effect"], f["effect"]), "location": f["location"], "p": f["probability"],
               "rivals": [[same.get(r["effect"], r["effect"]), r["location"], r["probability"]] for r in f["rivals"]],
               "sigmas": f["evidence"].get("sigmas_per_pose")} for f in found["findings"]]
    elements = claimed(trial.folder / "box", found)
    for c in claims:
        element = taken(trial, elements, c, same)
        c["element"] = wide(element) if element else ""
        c["is"] = next((j for j, t in enumerate(truths) if (t.effect, t.location) == (c["effect"], c["location"])), None)
        c["place"] = next((j for j, t in enumerate(truths) if same_place(trial, t.location, c["location"])), None)
        if c["is"] is not None and element:
            c["errors"] = errors(truths[c["is"]], element)
    facts = {"verdict": found["verdict"], "claims": claims, "hints": [[h["effect"], h["location"]] for h in found["hints"]],
             "outliers": found["outliers"], "faults": [[f["kind"], f["where"]] for f in found["faults"]],
             "noise": {k: found["noise"][k] for k in ("scale", "p_value", "p_white")},
             "before": found["heldout"]["before"], "after": found["heldout"]["after"], "chi2_before": found["baseline"]["chi2"],
             "chi2_after": found["after"]["chi2"], "fit_poses": found["poses"]["fit"]}
    if truths or claims:
        attainable(trial, truths, claims, facts)
    return facts


def attainable(trial, truths, claims, facts):
    """Fits of the truth's form, and of forms in which a claim stands for a truth, on sound rows only."""
    own = [t.element(free=True) if t.seen else "" for t in truths]
    fits = {"rigid": [], "truth": [e for e in own if e], "claimed": [c["element"] for c in claims]}
    for name, elements in fits.items():
        if name != "claimed" or all(elements):
            fit = fitted(trial, elements)
            facts[name] = fit and {k: fit[k] for k in ("chi2", "dof", "fit_rms", "heldout_rms")}
    best = facts.get("truth") and facts["truth"]["chi2"]
    for c in claims:
        if c["is"] is not None or not c["element"] or best is None:
            continue
        for j in range(len(truths)):
            if any(o["is"] == j for o in claims):
                continue
            fit = fitted(trial, [e for i, e in enumerate(own) if i != j and e] + [c["element"]])
            if fit and fit["chi2"] < best + TWIN:
                c["twin"] = j
                break


def fitted(trial, elements):
    try:
        return trial.forms.fit("sound.csv", elements, trial.lua if any("<strange" in e for e in elements) else "")
    except command.Refused:
        return None


def claimed(folder, found):
    """The effects of the extended model, findings and hints; their amounts free. None where the diagnosis left the model as it was."""
    if not found["extended_model"]:
        return []
    tree = xml.parse(folder / found["extended_model"]).getroot()
    nominal = {xml.tostring(e) for e in xml.parse(folder / "nominal.xml").getroot()}
    result = []
    for e in tree:
        if plugins.get(e.tag, {}).get("family") == "effect" and xml.tostring(e) not in nominal:
            e.tail = None
            result.append(e)
    return [xml.tostring(e, encoding="unicode") for e in result]


def taken(trial, elements, claim, same):
    """The element of a claim, taken out of the list; None if there is none."""
    for element in elements:
        e = xml.fromstring(element)
        tag = "unknown" if e.tag.startswith("unknown") else same.get(e.tag, e.tag)
        at = e.get("at", claim["location"])
        if tag == claim["effect"] and (at == claim["location"] or same_place(trial, at, claim["location"])):
            elements.remove(element)
            return element
    return None


def wide(element):
    """Amounts with room to move: ten times what they are or are uncertain by."""
    room = lambda m: f'"{m[1]} ± {10 * max(abs(float(m[1])), float(m[2])):.6g}{m[3]}"'
    return re.sub(r'"([^" ]+) ± ([^" ]+)([^"]*)"', room, element)


def same_place(trial, one, other):
    """A joint and the sensor that reads it are one place."""
    joint = {j.moved_by: j.name for j in trial.joints.values()}
    return joint.get(one, one) == joint.get(other, other)


def errors(truth, element):
    """Of the amounts of the right effect, in their usual sizes: the error as a share of the truth. What the recordings hardly show of an
    amount does not count. None where other settings were chosen."""
    e = xml.fromstring(element)
    if truth.driver and e.get("driver") != truth.driver:
        return None
    number = lambda text: float(text.split()[0])
    for name, (value, _) in truth.settings.items():
        if name in e.attrib and name not in ("pose", "session") and abs(number(e.get(name)) - value) > 1e-6 * abs(value):
            return None
    scale = 30 / number(e.get("per")) if "per" in e.attrib else 1.0  # amounts refer to that angle; 30 deg where nothing is said
    off = size = 0.0
    for name, (value, _) in truth.amounts.items():
        words = e.get(name, "0").split()
        spread = scale * float(words[2]) if len(words) > 2 else 0.0
        if spread < truth.usual[name]:
            off += ((scale * float(words[0]) - value) / truth.usual[name]) ** 2
            size += (value / truth.usual[name]) ** 2
    return math.sqrt(off / size) if size else None
