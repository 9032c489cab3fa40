"""From the facts of a trial to what counts: was something claimed where nothing is, was what is there found, at the right place, under the right name, or rightly left open?"""

STRONG = 4      # sigmas per pose from which on an effect must be found and named
CONFIDENT = 0.8
UNREACHABLE = 2  # chi-square per degree of freedom that the truth's own form leaves
SET = 3         # rivals that may be left open
CLAIMS = ("explained", "ambiguous", "unknown-physics")
QUIET = ("nothing", "more noise", "heavy tails", "wandering noise", "blunders")


def ran(records):
    return [r for r in records if "failed" not in r]


def quiet(r):
    return r["kind"] in QUIET


def claims_something(r):
    return r["verdict"] in CLAIMS


def confident(r, c):
    return r["verdict"] == "explained" and c["effect"] != "unknown" and c["p"] >= CONFIDENT


def reachable(r):
    """Does the truth's own form, fitted to sound rows, explain them? Not where a play is closed by a load that is nearly zero: which side it
    lies on then hangs on deviations of the geometry that the nominal model does not have."""
    return not r.get("truth") or r["truth"]["chi2"] < UNREACHABLE * r["truth"]["dof"]


def wrong_names(r):
    """Claims of an effect by name, with confidence, that is not there and does not explain the recordings as well as what is."""
    return [c for c in r["claims"] if confident(r, c) and c["is"] is None and c.get("twin") is None]


def other_names(r):
    """Confident claims under another name that explains the recordings as well: these do not tell which, so it should be left open."""
    return [c for c in r["claims"] if confident(r, c) and c["is"] is None and c.get("twin") is not None]


def kept_open(c):
    """The smallest set of names with 95 % of the probability, the likeliest first."""
    names, total = [], 0.0
    for effect, location, p in sorted([[c["effect"], c["location"], c["p"]], *c["rivals"]], key=lambda n: -n[2]):
        names.append((effect, location))
        total += p
        if total >= 0.95:
            break
    return names


def truths(r, catalogued=True):
    """(truth, its claims by place, how it was named) of each truth of a trial."""
    result = []
    for j, t in enumerate(r["truths"]):
        if t["catalogued"] == catalogued:
            result.append((t, placed(r, j), named(r, j)))
    return result


def placed(r, j):
    """Claims at the place of truth j, or that stand for it."""
    here = r["truths"][j]["location"]
    return [c for c in r["claims"] if j in (c["is"], c.get("twin")) or c["place"] == j
            or (c["place"] is not None and r["truths"][c["place"]]["location"] == here)]


def named(r, j):
    """"name", "set" (left open among few, the truth one of them), "equivalent" (another name that explains the recordings as well),
    "unknown" (found, and said to be none of the catalogue), "wide", "wrong" or ""."""
    t = r["truths"][j]
    name = (t["effect"], t["location"])
    own = [c for c in r["claims"] if c["is"] == j]
    if r["verdict"] == "unknown-physics" and placed(r, j):  # whatever stands beside it, that verdict takes all names back
        return "unknown"
    if own and (own[0]["p"] >= CONFIDENT or len(kept_open(own[0])) <= SET):
        return "name" if own[0]["p"] >= CONFIDENT else "set"
    sets = [kept_open(c) for c in r["claims"]]
    if any(name in s and len(s) <= SET for s in sets):
        return "set"
    if any(c.get("twin") == j for c in r["claims"]):
        return "equivalent"
    if any(name in s for s in sets):
        return "wide"
    if any(c["effect"] == "unknown" for c in placed(r, j)):
        return "unknown"
    return "wrong" if placed(r, j) else ""


def gained(r):
    """Share of the attainable drop of the mean square of held-out rows; None where there is next to nothing to gain."""
    if not all(r.get(k) for k in ("rigid", "truth", "claimed")):
        return None
    rigid, truth, claimed = (r[k]["heldout_rms"] ** 2 for k in ("rigid", "truth", "claimed"))
    return (rigid - claimed) / (rigid - truth) if rigid > 1.5 * truth else None


def stated(r):
    """(probability, right) of every name that a diagnosis gave a probability to."""
    there = {(t["effect"], t["location"]) for t in r["truths"]}

    def right(effect, location, place):
        if effect == "unknown":
            return place is not None and not r["truths"][place]["catalogued"]
        return (effect, location) in there

    result = []
    for c in r["claims"]:
        result.append((c["p"], right(c["effect"], c["location"], c["place"])))
        result += [(p, right(e, at, c["place"] if at == c["location"] else None)) for e, at, p in c["rivals"]]
    return result


def faults_found(r):
    """Of recordings with a wrong column: is it said, with the right column's name?"""
    what, *where = r.get("faulty") or ["-"]
    where = [w.split("[")[0] for w in where]
    return any(kind == what and any(w in place or w.split(".")[0] == place for w in where) for kind, place in r["faults"])


def failures(records):
    """One line per trial that is not as it should be."""
    lines = []
    for r in records:
        for what in wrongs(r):
            if "failed" in r:
                lines.append(f"{r['trial']:5} failed: {r['failed'][:200]}")
                continue
            key = "; ".join(f"{t['effect']}{' ' + t['words'] if t['words'] else ''} at {t['location']} {t['strength']:.1f}" for t in r["truths"])
            said = "; ".join(f"{c['effect']} at {c['location']} ({c['p']:.2f})" + ("" if c.get("twin") is None else " twin") for c in r["claims"])
            lines.append(f"{r['trial']:5} {what:22} {r['device']:18} {r['kind']}: {key or r['wrong'] or 'nothing'} -> {r['verdict']}: {said}")
    return sorted(lines, key=lambda line: line[6:28])


def wrongs(r):
    if "failed" in r:
        return ["failed"]
    found = []
    if quiet(r) and claims_something(r):
        found.append("false alarm")
    if wrong_names(r):
        found.append("wrong name")
    for t, place, name in truths(r):
        if t["strength"] >= STRONG and reachable(r):
            if not place:
                found.append("not found, strong")
            elif name == "unknown" and any(t is r["truths"][c["is"]] for c in place if c["is"] is not None):
                found.append("named, then withdrawn")
            elif name not in ("name", "set", "equivalent"):
                found.append(f"name: {name}")
    for t, place, _ in truths(r, False):
        if t["strength"] >= STRONG and not place:
            found.append("unknown, not found")
        elif t["strength"] >= STRONG and r["verdict"] != "unknown-physics":
            found.append("unknown, not said")
    share = gained(r)
    if share is not None and share < 0.9 and any(t["strength"] >= STRONG for t in r["truths"]):
        found.append("gained too little")
    if r["kind"] == "wrong column" and not faults_found(r):
        found.append("wrong column")
    if r["kind"] != "heavy tails" and set(r["outliers"]) - set(r["bad"]):
        found.append("sound rows left out")
    if set(r["bad"]) - set(r["outliers"]):
        found.append("blunders missed")
    return found
