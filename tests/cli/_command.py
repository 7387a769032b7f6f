"""Runs the command as a user would, and counts what is checked."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

COMMAND = os.environ.get("VDB_OFFSET", "vdb-offset")
SOURCE = Path(os.environ.get("VDB_OFFSET_SOURCE_DIR", Path(__file__).parents[2]))
DATA = Path(os.environ.get("VDB_OFFSET_SHARED_DATA", SOURCE.parent / "shared" / "data"))

failures = 0


def run(*arguments, cwd=None, timeout=300, env=None):
    return subprocess.run(
        [COMMAND, *map(str, arguments)],
        cwd=cwd,
        env=env,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=timeout,
    )


def wait_for_handler(process, number, seconds=30):
    """Until the process catches the signal; loading may take a loaded machine a second."""
    end = time.monotonic() + seconds
    while process.poll() is None and time.monotonic() < end:
        status = Path(f"/proc/{process.pid}/status").read_text()
        caught = int(status.split("SigCgt:")[1].split()[0], 16)
        if caught >> (number - 1) & 1:
            return
        time.sleep(0.01)


def check(claim, holds, detail=""):
    global failures
    print(("ok    " if holds else "FAIL  ") + claim)
    if not holds:
        failures += 1
        print("      " + str(detail).replace("\n", "\n      "))


def check_exit(claim, result, code, *parts):
    """Exit code, and every part of the message on standard error."""
    said = result.stderr
    missing = [part for part in parts if part not in said]
    check(
        f"{claim}: exit {code}" + (f", names {', '.join(parts)}" if parts else ""),
        result.returncode == code and not missing,
        f"exit {result.returncode}, missing {missing}\n{said}{result.stdout[-500:]}",
    )


def example(folder, name, *options):
    file = Path(folder) / f"{name}.xyz"
    made = run("example", name, "-o", file, *options)
    check_exit(f"example {name} {' '.join(map(str, options))}", made, 0)
    return file


def scratch():
    return tempfile.TemporaryDirectory(prefix="vdb-offset-test-")


def listing(folder):
    return sorted(str(p.relative_to(folder)) for p in Path(folder).rglob("*"))


def finish():
    sys.exit(1 if failures else 0)


def skip(why):
    print("skipped: " + why)
    sys.exit(77)
