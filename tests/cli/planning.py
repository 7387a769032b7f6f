"""Planning: it ends at any distance, can be interrupted, and its memory is what a run takes."""

import json
import os
import resource
import signal
import subprocess
import time
from pathlib import Path

from _command import (COMMAND, DATA, check, check_exit, example, finish, run, scratch,
                      wait_for_handler)

SANITIZED = bool(os.environ.get("VDB_OFFSET_SANITIZED"))


def busy():
    """Seconds that finished runs took of a processor: a busy machine does not count."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def ends(file, *options):
    # Sanitized code takes minutes for what is counted at great distances.
    for power in [1, 99] if SANITIZED else [1, 3, 7, 14, 99]:
        for memory in ["300M", "8G"]:
            start = busy()
            plan = run("mesh", file, "--distance", f"1e{power}", "--memory", memory, "--dry-run",
                       *options)
            took = busy() - start
            name = f"--distance 1e{power} --memory {memory} {' '.join(options)}"
            # Seconds where this was written; hours before the counting was bounded.
            check(f"{name} ends ({took:.1f} s of a processor)", SANITIZED or took < 60, plan)
            check(f"{name}: a plan, or why there is none",
                  (plan.returncode == 0 and "voxel" in plan.stdout)
                  or (plan.returncode in (2, 4) and f"{float('1e%d' % power):g}" in plan.stderr
                      and "--" in plan.stderr), plan)


def interrupted(file):
    process = subprocess.Popen(
        [COMMAND, "mesh", file, "--distance", "3", "--voxel", "0.0005", "--memory", "100T",
         "--threads", "1", "--dry-run"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for_handler(process, signal.SIGINT)
    time.sleep(0.1)
    alive = process.poll() is None
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    # A machine that plans it within the wait has nothing to interrupt.
    check("SIGINT while planning: exit 130", not alive or process.returncode == 130,
          (process.returncode, out, err))


def memory(name, file, folder, *options, limit=None):
    """The plan covers the peak of the run without its repair, and not by far."""
    if SANITIZED:
        print(f"skipped: {name}: a sanitizer's memory is its own")
        return
    report = Path(folder) / "memory.json"
    done = run("mesh", file, *options, "--repair", "off", "--report", report,
               *(["--memory", limit] if limit else []))
    if done.returncode not in (0, 1):
        check(f"{name}: a run", False, done)
        return
    out = json.loads(report.read_text())
    planned, peak = out["field"]["planned_bytes"], out["run"]["peak_memory_bytes"]
    ratio = planned / peak
    said = f"planned {planned / 1e6:.0f} MB, peak {peak / 1e6:.0f} MB"
    # Libraries take more or less of it from one system to the next.
    check(f"{name}: {said}", 0.9 <= ratio <= 1.4, ratio)
    if limit:
        check(f"{name}: within --memory", peak <= 1.1 * out["field"]["limit_bytes"])


def within(file, folder, *options):
    """What the repair is said to take covers what it takes."""
    if SANITIZED:
        print("skipped: a repair within --memory: a sanitizer's memory is its own")
        return
    report = Path(folder) / "memory.json"
    check_exit("a repair beyond --memory",
               run("mesh", file, *options, "--memory", "150M"), 4, "repair", "150.00 MiB")
    done = run("mesh", file, *options, "--memory", "300M", "--report", report)
    check("a repair within --memory: a run", done.returncode == 0, done)
    if done.returncode == 0:
        out = json.loads(report.read_text())
        peak, limit = out["run"]["peak_memory_bytes"], out["field"]["limit_bytes"]
        check(f"a repair within --memory: peak {peak / 1e6:.0f} of {limit / 1e6:.0f} MB",
              out["repair"]["columns"] > 0 and peak <= 1.1 * limit)


with scratch() as folder:
    sphere = example(folder, "sphere", "--points", 33)
    ends(sphere)
    ends(sphere, "--side", "against")
    interrupted(sphere)
    check_exit("--memory below the program's own",
               run("mesh", sphere, "--distance", 0.5, "--memory", "5M", "-o",
                   Path(folder) / "a.xyz"), 4, "5.00 MiB", "program", "--memory")

    tube = example(folder, "draft-tube")
    vdb = ["--vdb", Path(folder) / "a.vdb"]
    vtm = ["-o", Path(folder) / "a.vtm"]
    near = ["--distance", 0.5, "--layers", 16, "--voxel", 0.02]
    memory("sphere, vtm", sphere, folder, *near, *vtm)
    memory("sphere, vdb", sphere, folder, *near, *vtm, *vdb)
    memory("sphere, all grids", sphere, folder, *near, *vtm, *vdb, "--grids", "phi,normal,feature")
    memory("draft tube", tube, folder, "--distance", 0.2, *vtm, *vdb, limit="150M")
    bar = example(folder, "l-bar", "--points", 33)
    within(bar, folder, "--distance", 0.3, "--layers", 64, *vtm)
    wing = DATA / "plot3d" / "bwb.fmt"
    if wing.is_file():
        memory("bwb", wing, folder, "--distance", 2, "--layers", 48, "--first-cell", 1e-4, *vtm,
               *vdb)
    else:
        print("skipped: bwb.fmt is not there")

finish()
