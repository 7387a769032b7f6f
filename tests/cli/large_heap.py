"""mesh and field start anew with a heap in large pages, once, and say and write the same."""

import os
import subprocess
import time
from pathlib import Path

from _command import COMMAND, check, check_exit, example, finish, run, scratch

THP = Path("/sys/kernel/mm/transparent_hugepage/enabled")
ASKED = "glibc.malloc.hugetlb=1"
bare = {k: v for k, v in os.environ.items() if k != "GLIBC_TUNABLES"}
FIELD = ["field", "sphere.xyz", "--distance", "0.3"]


def tunables_of(process, seconds=30):
    """What the process has by then, of those that it was started with or has started with anew."""
    seen = None
    end = time.monotonic() + seconds
    while process.poll() is None and time.monotonic() < end:
        words = Path(f"/proc/{process.pid}/environ").read_bytes().decode().split("\0")
        seen = next((w.split("=", 1)[1] for w in words if w.startswith("GLIBC_TUNABLES=")), seen)
        if seen is not None:
            break
        time.sleep(0.002)
    process.kill()
    process.communicate()
    return seen


def start(env):
    # Long enough to be looked at.
    return subprocess.Popen([COMMAND, *FIELD, "--voxel", "0.004", "-o", "long.vdb"], cwd=folder,
                            env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


with scratch() as folder:
    example(folder, "sphere", "--points", 33)
    written = []
    for name, env in [("anew", bare), ("as it is", {**bare, "GLIBC_TUNABLES": ""})]:
        result = run(*FIELD, "-o", "out.vdb", cwd=folder, env=env)
        check_exit(f"field, {name}", result, 0)
        listed = run("info", "out.vdb", "--json", cwd=folder, env=env)
        check_exit(f"info of it, {name}", listed, 0)
        written.append(listed.stdout)
    check("the same field", written[0] == written[1] and "phi" in written[0], written)
    wrong = run(*FIELD, "--voxel", "-1", "-o", "no.vdb", cwd=folder, env=bare)
    check_exit("a wrong option is told", wrong, 2, "voxel")
    linked = Path(folder) / "another name"
    linked.symlink_to(COMMAND)
    result = subprocess.run([linked, *FIELD, "-o", "linked.vdb"], cwd=folder, env=bare,
                            capture_output=True, text=True)
    check_exit("by a link of another name", result, 0)

    if THP.exists() and "[madvise]" in THP.read_text():
        seen = tunables_of(start(bare))
        check("where the kernel waits to be asked, the heap asks", seen == ASKED, seen)
    else:
        print("skipped: this kernel gives large pages to all, or to none")
    own = {**bare, "GLIBC_TUNABLES": "glibc.malloc.arena_max=2"}
    seen = tunables_of(start(own))
    check("tunables of the user's own stay", seen == "glibc.malloc.arena_max=2", seen)

finish()
