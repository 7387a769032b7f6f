#!/usr/bin/python3
"""Layers on every surface file of folders, one line a file.

    file_table.py [--only SUBSTRING] [--seconds S] [--memory GB] [--to FILE] FOLDER...

`mesh` runs with its own choices at a tenth of the size (the longest side of the box that `info`
finds; 1 where it finds none), 32 layers from 1e-4 of the size. A line has the file, the exit code,
seconds, the peak of memory, cells, those that are not positive, the least scaled Jacobian, and the
first thing that was said where it was refused. What took longer than S seconds (600), or more
memory than GB of addresses (12), is ended. With --to, lines are added to a file, and files that it
has already are passed over. Exits 1 where a run crashed, took too long, or made a bad cell.
"""

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from _command import COMMAND  # noqa: E402


def size_of(file):
    said = subprocess.run([COMMAND, "info", "--json", file], capture_output=True, text=True,
                          errors="replace", timeout=600)
    try:
        bounds = json.loads(said.stdout)["surface"]["bounds"]
        return max(b - a for a, b in zip(bounds["min"], bounds["max"])) or 1.0
    except (json.JSONDecodeError, KeyError, TypeError):
        return 1.0


def measured(arguments, seconds, memory):
    """Exit code (negative: the signal that ended it), seconds, peak bytes, standard error."""
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        os.setsid()

    with tempfile.TemporaryFile("w+", errors="replace") as said:
        start = time.monotonic()
        process = subprocess.Popen([COMMAND, *map(str, arguments)], stdout=subprocess.DEVNULL,
                                   stderr=said, preexec_fn=limit)
        while True:
            done, status, usage = os.wait4(process.pid, os.WNOHANG)
            if done:
                break
            if time.monotonic() - start > seconds:
                os.killpg(process.pid, signal.SIGKILL)
            time.sleep(0.02)
        took = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return process.returncode, took, usage.ru_maxrss * 1024, said.read()


def reason(said):
    lines = said.splitlines()
    lines = [line for line in lines if line.startswith("vdb-offset:")] or lines
    return " ".join(lines[:1]).replace("\t", " ")[:200]


def line_of(file, folder, options):
    size = size_of(file)
    report = Path(folder) / "report.json"
    report.unlink(missing_ok=True)
    code, took, peak, said = measured(
        ["mesh", file, "--distance", 0.1 * size, "--first-cell", 1e-4 * size, "--layers", 32, "-o",
         Path(folder) / "mesh.vtu", "--report", report], options.seconds,
        int(options.memory * 2**30))
    cells = bad = least = ""
    if report.exists():
        found = json.loads(report.read_text())
        cells, bad = found["blocks"]["cells"], found["quality"]["nonpositive_cells"]
        least = f"{found['quality']['min_scaled_jacobian']:.4f}"
    why = reason(said) if not report.exists() else ""
    is_bad = code not in (0, 2, 3) or (code == 0 and bad != 0)
    fields = [f"{file.parent.name}/{file.name}", code, f"{took:.1f}", f"{peak / 2**20:.0f}", cells,
              bad, least, why]
    return "\t".join(map(str, fields)), is_bad


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--memory", type=float, default=12)
    parser.add_argument("--to", type=Path)
    options = parser.parse_args()
    print("file\texit\tseconds\tMB\tcells\tbad\tleast\tsaid")
    known = set()
    if options.to and options.to.exists():
        known = {line.split("\t")[0] for line in options.to.read_text().splitlines()}
    failed = False
    for file in [f for folder in options.folders for f in sorted(folder.iterdir())]:
        name = f"{file.parent.name}/{file.name}"
        if options.only not in name or name in known or not file.is_file():
            continue
        with tempfile.TemporaryDirectory() as folder:
            line, is_bad = line_of(file, folder, options)
        failed = failed or is_bad
        print(line, flush=True)
        if options.to:
            with options.to.open("a") as out:
                out.write(line + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
