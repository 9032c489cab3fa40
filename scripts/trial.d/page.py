"""The tables of the blind trial, from the records."""
import statistics

import common, judge
from judge import STRONG

BINS = ((0, 0.3), (0.3, 0.7), (0.7, 1.5), (1.5, 4), (4, 10), (10, 1e9))
STATED = ((0, 0.05), (0.05, 0.2), (0.2, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 1.01))


def lines(records):
    ran = judge.ran(records)
    if not ran:
        return ["No trial has been run."]
    parts = (head(records, ran), goals(ran), strengths(ran), quiet(ran), unknown(ran), devices(ran), effects(ran), rest(ran))
    return [line for part in parts for line in (*part, "")][:-1]


def fill(records):
    ran = judge.ran(records)
    common.fill("docs/proof.md", "trial", lines(records))
    common.fill("docs/diagnosis.md", "false alarms", alarms(ran))
    common.fill("docs/diagnosis.md", "probabilities", probabilities(ran))


def head(records, ran):
    failed = len(records) - len(ran)
    lost = sum(t["strength"] >= STRONG for r in ran if not judge.reachable(r) for t, *_ in judge.truths(r))
    seconds = statistics.median(r["seconds"] for r in ran)
    return [f"{len(records)} trials, seed {records[0]['seed']}: `scripts/blind-trial --trials {max(r['trial'] for r in records)}"
            + (f" --seed {records[0]['seed']}`. " if records[0]["seed"] != 1 else "`. ")
            + (f"{failed} could not be run. " if failed else "")
            + (f"{lost} effects of 4 sigmas or more are not counted below, since not even their own formula fits them (play that is closed by a "
               "load of next to nothing lies on a side that deviations of the geometry choose). " if lost else "")
            + "Of each a device, its true geometry, its poses and circumstances, noise, and what is wrong with it are drawn at random: "
            "nothing, one to three effects of the catalogue of random kind, place and size, an effect that is not in the catalogue, or bad "
            "recordings. The diagnosis sees the recordings and the nominal model. "
            f"A diagnosis takes {seconds:.1f} s of one processor in the median.",
            "",
            "An effect's *strength* is what it leaves in a pose when geometry and the other effects of the trial have taken up what they can: the "
            "root mean square over the poses of the length of the whitened residual vector, in sigmas, without noise. A claim under another "
            "name is *equivalent* if, put in place of the truth, it fits these very recordings as well (chi-square less than 9 worse). "
            "Intervals are of 95 %."]


def share(items, test):
    items = list(items)
    return common.share(sum(bool(test(i)) for i in items), len(items)) if items else "-"


def strong(ran):
    return [(r, *t) for r in ran if judge.reachable(r) for t in judge.truths(r) if t[0]["strength"] >= STRONG]


def strange(ran, least=STRONG):
    return [(r, *t) for r in ran for t in judge.truths(r, False) if t[0]["strength"] >= least]


def goals(ran):
    calm, known, new = [r for r in ran if r["kind"] == "nothing"], strong(ran), strange(ran)
    gains = [judge.gained(r) for r in ran if any(t["strength"] >= STRONG for t in r["truths"])]
    gains = [g for g in gains if g is not None]
    text = f"median {100 * statistics.median(gains):.1f} %; {share(gains, lambda g: g >= 0.95)} reach 95 %" if gains else "-"
    return ["| | goal | result |", "| --- | --- | --- |",
            f"| something claimed where nothing is | at most 2 % | {share(calm, judge.claims_something)} |",
            f"| the same with bad noise or blunders | | {share([r for r in ran if judge.quiet(r) and r not in calm], judge.claims_something)} |",
            f"| a wrong name given with confidence, of all trials | at most 1 % | {share(ran, judge.wrong_names)} |",
            f"| an equivalent name given with confidence, where it should be left open | | {share(ran, lambda r: judge.other_names(r) and all(t['catalogued'] for t in r['truths']))} |",
            f"| effects of {STRONG} sigmas or more: right place | 98 % | {share(known, lambda k: k[2])} |",
            f"| right name, or one of at most {judge.SET} left open | 97 % | {share(known, lambda k: k[3] in ('name', 'set'))} |",
            f"| the same or an equivalent name | | {share(known, lambda k: k[3] in ('name', 'set', 'equivalent'))} |",
            f"| physics outside the catalogue, {STRONG} sigmas or more: right place | 90 % | {share(new, lambda k: k[2])} |",
            f"| given a catalogue's name with confidence | never | {share(new, lambda k: judge.wrong_names(k[0]))} |",
            f"| the same, the name being equivalent | | {share(new, lambda k: judge.other_names(k[0]))} |",
            f"| drop of held-out residuals, share of the attainable | 95 % | {text} |"]


def strengths(ran):
    result = ["### Detection against strength", "",
              "| sigmas per pose | effects | found at its place | named | left open among few | equivalent name | called unknown | other | error of its amounts |",
              "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for low, high in BINS:
        own = [t for r in ran if judge.reachable(r) for t in judge.truths(r) if low <= t[0]["strength"] < high]
        if not own:
            continue
        names = [t[2] for t in own]
        off = [c["errors"] for r in ran for c in r["claims"] if c["is"] is not None and c.get("errors") is not None
               and low <= r["truths"][c["is"]]["strength"] < high]
        counts = [names.count(n) for n in ("name", "set", "equivalent", "unknown")]
        other = sum(n in ("wide", "wrong") for n in names)
        title = f"{low:g} to {high:g}" if high < 1e9 else f"above {low:g}"
        result.append(f"| {title} | {len(own)} | {share(own, lambda t: t[1])} | " + " | ".join(map(str, counts)) + f" | {other} | "
                      + (f"{100 * statistics.median(off):.1f} %" if off else "-") + " |")
    return [*result, "", "The last column is the median error of a right effect's amounts, as a share of their size."]


def quiet(ran):
    result = ["### Where no effect is", "", "| recordings | | nothing-missing | bad-data | ambiguous | unknown-physics | explained |",
              "| --- | --- | --- | --- | --- | --- | --- |"]
    for kind in judge.QUIET:
        own = [r["verdict"] for r in ran if r["kind"] == kind]
        if own:
            counts = [own.count(v) for v in ("nothing-missing", "bad-data", "ambiguous", "unknown-physics", "explained")]
            result.append(f"| {kind} | {len(own)} | " + " | ".join(map(str, counts)) + " |")
    columns = [r for r in ran if r["kind"] == "wrong column"]
    bad = [r for r in ran if r["bad"]]
    result += ["", f"Columns exchanged or of the wrong sign: found and said in {share(columns, judge.faults_found)}. "
               f"Recordings with blunders: all of them found in {share(bad, lambda r: set(r['bad']) <= set(r['outliers']))}. "
               f"Sound rows left out: in {share([r for r in ran if r['kind'] != 'heavy tails'], lambda r: set(r['outliers']) - set(r['bad']))}."]
    return result


def unknown(ran):
    result = ["### Physics outside the catalogue", "", "| sigmas per pose | trials | something claimed | right place | unknown-physics | ambiguous "
              "| a catalogue's name with confidence | an equivalent one |", "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    for low, high in BINS:
        own = [k for k in strange(ran, low) if k[1]["strength"] < high]
        if own:
            equal = [k for k in own if judge.other_names(k[0])]
            title = f"{low:g} to {high:g}" if high < 1e9 else f"above {low:g}"
            counts = (sum(judge.claims_something(k[0]) for k in own), sum(bool(k[2]) for k in own),
                      *(sum(k[0]["verdict"] == v for k in own) for v in ("unknown-physics", "ambiguous")),
                      sum(bool(judge.wrong_names(k[0])) for k in own), len(equal))
            result.append(f"| {title} | {len(own)} | " + " | ".join(map(str, counts)) + " |")
    return result


def devices(ran):
    result = ["### By device", "", f"| device | trials | claimed where nothing is | wrong confident names | effects of {STRONG} sigmas | right place "
              "| name, few or equivalent | seconds |", "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    for device in sorted({r["device"] for r in ran}):
        own = [r for r in ran if r["device"] == device]
        calm, known = [r for r in own if r["kind"] == "nothing"], strong(own)
        result.append(f"| {device} | {len(own)} | {sum(map(judge.claims_something, calm))} of {len(calm)} | {sum(bool(judge.wrong_names(r)) for r in own)} | "
                      f"{len(known)} | {sum(bool(k[2]) for k in known)} | {sum(k[3] in ('name', 'set', 'equivalent') for k in known)} | "
                      f"{statistics.median(r['seconds'] for r in own):.1f} |")
    return result


def effects(ran):
    result = ["### By effect", "", f"| effect of {STRONG} sigmas or more | drawn | right place | named | left open among few | equivalent name |",
              "| --- | --- | --- | --- | --- | --- |"]
    known = strong(ran)
    for effect in sorted({k[1]["effect"] for k in known}):
        own = [k for k in known if k[1]["effect"] == effect]
        counts = [sum(k[3] == n for k in own) for n in ("name", "set", "equivalent")]
        result.append(f"| {effect} | {len(own)} | {sum(bool(k[2]) for k in own)} | " + " | ".join(map(str, counts)) + " |")
    return result


def rest(ran):
    """Ambiguity, and the probabilities."""
    open_ = [r for r in ran if r["verdict"] == "ambiguous" and r["claims"] and any(t["catalogued"] for t in r["truths"])]
    inside = lambda r: any((t["effect"], t["location"]) in judge.kept_open(c) for t in r["truths"] for c in r["claims"])
    bare = [r for r in ran if r["verdict"] == "ambiguous" and not r["claims"]]
    wide = [len(judge.kept_open(c)) for r in open_ for c in r["claims"] if c["p"] < judge.CONFIDENT]
    text = f"Called ambiguous, with names: the truth is among those with 95 % of the probability in {share(open_, inside)}"
    text += f", {statistics.median(wide):g} names in the median." if wide else "."
    return ["### What is left open, and the probabilities", "", text + f" Ambiguous without any name: {len(bare)}.", "", *probabilities(ran)]


def alarms(ran):
    result = ["| device | recordings without effect | called explained, ambiguous or unknown |", "| --- | --- | --- |"]
    calm = [r for r in ran if r["kind"] == "nothing"]
    for device in [*sorted({r["device"] for r in calm}), "all"]:
        own = [r for r in calm if device in (r["device"], "all")]
        result.append(f"| {device} | {len(own)} | {share(own, judge.claims_something)} |")
    return result


def probabilities(ran):
    said = [s for r in ran if r["truths"] for s in judge.stated(r)]
    result = ["| probability stated | said of | right | mean stated |", "| --- | --- | --- | --- |"]
    for low, high in STATED:
        own = [s for s in said if low <= s[0] < high]
        if own:
            mean = statistics.mean(s[0] for s in own)
            result.append(f"| {low} to {min(1, high)} | {len(own)} | {share(own, lambda s: s[1])} | {mean:.2f} |")
    return result
