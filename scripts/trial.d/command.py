"""Running the command, and reading what it writes."""
import csv, json, os, pathlib, resource, subprocess

root = pathlib.Path(__file__).resolve().parents[2]
talus = os.environ.get("TALUS", str(root / "build/talus"))


class Refused(Exception):
    """The command ended with 2: this model or table cannot be."""


def run(folder, *words, allowed=(0, 1), limit=900):
    """Runs the command in a folder; what it says on standard output."""
    done = subprocess.run([talus, *map(str, words)], cwd=folder, check=False, capture_output=True, text=True, timeout=limit)
    if done.returncode not in allowed:
        raise Refused(f"talus {' '.join(map(str, words))}: {done.returncode}\n{done.stderr}")
    return done.stdout


def timed(folder, output, *words, limit=1200):
    """Runs the command, what it says going to a file; the processor's seconds."""
    bounded = lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    with open(folder / output, "w", encoding="utf-8") as out:
        process = subprocess.Popen([talus, *map(str, words)], cwd=folder, stdout=out, stderr=out, preexec_fn=bounded)
        _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        said = (folder / output).read_text(encoding="utf-8")[-2000:]
        raise Refused(f"talus {' '.join(map(str, words))}: {os.waitstatus_to_exitcode(status)}\n{said}")
    return used.ru_utime + used.ru_stime


def registered():
    return json.loads(run(root, "plugins", "--json", "-"))["plugins"]


def simulate(folder, model, poses, file, seed=1, noise=1.0):
    run(folder, "simulate", model, "--poses", poses, "--seed", seed, "--noise", f"{noise:.6g}", "--threads", 1, "--recordings", file)
    return read(folder / file)


def calibrate(folder, model, recordings):
    """`baseline` of a calibration's JSON."""
    run(folder, "calibrate", model, recordings, "--quiet", "--threads", 1, "--out", "fit", "--json", "fit.json")
    return load(folder / "fit.json")["baseline"]


def load(file):
    return json.loads(pathlib.Path(file).read_text(encoding="utf-8"))


def read(file):
    """A table: names of columns with their units, rows of text."""
    with open(file, encoding="utf-8") as lines:
        rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    return rows[0], rows[1:]


def write(file, names, rows):
    text = "\n".join(",".join(row) for row in [names, *rows]) + "\n"
    pathlib.Path(file).write_text(text, encoding="utf-8")
