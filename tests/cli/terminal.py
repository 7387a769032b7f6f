"""On a terminal there is a progress bar for what lasts; --quiet and a pipe have none."""

import os
import pty
import subprocess

from _command import COMMAND, check, example, finish, scratch, skip


def on_a_terminal(folder, *arguments):
    ours, theirs = pty.openpty()
    process = subprocess.Popen([COMMAND, *arguments], cwd=folder, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    said = b""
    while True:
        try:
            piece = os.read(ours, 4096)
        except OSError:  # how Linux reports that the other end has been closed
            break
        if not piece:
            break
        said += piece
    out = process.communicate(timeout=120)[0]
    os.close(ours)
    return process.returncode, said.decode(), out.decode()


try:
    os.close(pty.openpty()[0])
except OSError as error:
    skip(f"no terminal can be made here: {error}")

with scratch() as folder:
    example(folder, "sphere", "--points", 129)
    long_run = ["mesh", "sphere.xyz", "--distance", "0.9", "--voxel", "0.02", "--memory", "2G",
                "--threads", "1", "--layers", "64", "-o", "out.xyz"]
    code, said, out = on_a_terminal(folder, *long_run)
    check("a long run on a terminal is done", code == 0, said)
    check("it draws a bar with the stage and its part", "\r" in said and " %" in said
          and "march      [" in said, said)
    lines = [line.split("\x1b[K")[-1] for line in said.split("\n")]
    check("the bar is gone before the lines of the stages",
          all("[#" not in line and "[." not in line for line in lines if " s]" in line), lines)
    check("standard output stays empty", out == "", out)
    code, said, out = on_a_terminal(folder, *long_run, "--quiet")
    check("--quiet draws nothing", code == 0 and said == "", said)

finish()
