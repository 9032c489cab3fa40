"""What the scripts in this folder share: running the command and reading its JSON."""
import csv, json, math, os, pathlib, re, subprocess, tempfile

root = pathlib.Path(__file__).resolve().parents[2]
talus = os.environ.get("TALUS", str(root / "build/talus"))


def run(*words, allowed=(0,)):
    """Runs the command from the top of the tree, so that its paths are those a reader would type."""
    done = subprocess.run([talus, *map(str, words)], cwd=root, check=False, stderr=subprocess.PIPE, text=True)
    if done.returncode not in allowed:
        raise SystemExit(f"talus {' '.join(map(str, words))} ended with {done.returncode}\n{done.stderr}")


def calibrate(model, recordings, *more):
    """The JSON of a calibration; the calibrated model goes to a scratch folder."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "fit.json")
        run("calibrate", model, recordings, *more, "--quiet", "--out", folder, "--json", file, allowed=(0, 1))
        return json.loads(file.read_text(encoding="utf-8"))


def table(file):
    """The columns of a CSV file, without the units in their names."""
    with open(pathlib.Path(root, file), encoding="utf-8") as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    return {name.split("[")[0]: [float(row[name]) for row in rows] for name in rows[0]}


def rms(values):
    values = list(values)
    return math.sqrt(sum(v * v for v in values) / len(values)) if values else math.nan


def write(file, text):
    pathlib.Path(root, file).write_text(text, encoding="utf-8")
    print(f"wrote {file}")


def share(hits, runs):
    """A count with the 95 % interval of Wilson."""
    z, p = 1.96, hits / max(1, runs)
    middle, half = p + z * z / (2 * runs), z * math.sqrt(p * (1 - p) / runs + z * z / (4 * runs * runs))
    below, above = (max(0, middle - half), middle + half)
    return f"{hits} of {runs} ({100 * below / (1 + z * z / runs):.1f} to {100 * above / (1 + z * z / runs):.1f} %)"


def fill(file, part, lines):
    """Puts lines between `<!-- part: NAME -->` and the next `<!-- end -->` of a page."""
    text = pathlib.Path(root, file).read_text(encoding="utf-8")
    marked = rf"(<!-- part: {part} -->\n).*?(<!-- end -->)"
    if not re.search(marked, text, flags=re.S):
        raise SystemExit(f"{file} has no lines \"<!-- part: {part} -->\" and \"<!-- end -->\"")
    write(file, re.sub(marked, lambda m: m[1] + "\n".join(lines) + "\n" + m[2], text, flags=re.S))


def generated(script, *arguments):
    return f"<!-- Written by scripts/figures/{' '.join((script, *arguments))}; do not edit. -->\n\n"
