"""Ctrl-C: exit 130, and nothing half-written is left."""

import signal
import subprocess
import time
from pathlib import Path

from _command import COMMAND, check, example, finish, listing, scratch, wait_for_handler


def start(folder):
    # Nodes and voxels enough that one thread marches for many seconds.
    return subprocess.Popen(
        [COMMAND, "mesh", "sphere.xyz", "--distance", "0.9", "--voxel", "0.012", "--memory", "3G",
         "--threads", "1", "--layers", "64",
         "-o", "out.xyz", "-o", "out.vtm", "--vdb", "out.vdb", "--report", "out.json"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


with scratch() as folder:
    example(folder, "sphere", "--points", 129)
    before = listing(Path(folder))
    for number, name in [(signal.SIGINT, "SIGINT"), (signal.SIGTERM, "SIGTERM")]:
        for wait in [0.1, 1.0]:
            process = start(folder)
            wait_for_handler(process, number)
            time.sleep(wait)
            alive = process.poll() is None
            process.send_signal(number)
            sent = time.monotonic()
            out, err = process.communicate(timeout=60)
            lag = time.monotonic() - sent
            check(f"{name} after {wait} s: the run was under way", alive, err)
            check(f"{name} after {wait} s: exit 130", process.returncode == 130,
                  (process.returncode, err))
            check(f"{name} after {wait} s: it says so, on standard error",
                  "interrupted" in err and out == "", err + out)
            check(f"{name} after {wait} s: within 5 s", lag < 5, lag)
            check(f"{name} after {wait} s: no file is left", listing(Path(folder)) == before,
                  listing(Path(folder)))

    process = start(folder)
    wait_for_handler(process, signal.SIGTERM)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    check("a second signal ends it too: exit 130", process.returncode == 130, process.returncode)
    left = [f for f in listing(Path(folder)) if f not in before and ".part" not in f]
    check("after two signals no output has its final name", not left, left)

finish()
