"""OpenFOAM as an outside judge, and its files read by code of our own here."""

import os
import re
import shutil
import subprocess
from pathlib import Path

from _command import check

FOAM = Path("/usr/share/openfoam")
JUDGE = shutil.which("checkMesh")


def verdict(case):
    """What is wrong, by checkMesh, which exits 0 whatever it finds."""
    environment = {**os.environ, "WM_PROJECT_DIR": str(FOAM)}
    said = subprocess.run([JUDGE, "-constant", "-allTopology"], cwd=case, env=environment,
                          capture_output=True, text=True)
    text = said.stdout + said.stderr
    faults = re.findall(r"^ *\*\*.*$|^.*FATAL.*$", text, re.M)
    return "" if "Mesh OK." in text and not faults else "\n".join(faults) or text[-2000:]


def patches(case):
    """Name, type, faces and first face of each patch."""
    text = (Path(case) / "constant/polyMesh/boundary").read_text()
    found = re.findall(r"(\S+)\s*\{\s*type\s+(\w+);.*?nFaces\s+(\d+);\s*startFace\s+(\d+);",
                       text, re.S)
    return {name: (kind, int(faces), int(start)) for name, kind, faces, start in found}


def note(case):
    text = (Path(case) / "constant/polyMesh/owner").read_text()[:500]
    return {key: int(value) for key, value in re.findall(r"(n\w+):(\d+)", text)}


def judged(case):
    if JUDGE:
        wrong = verdict(case)
        check(f"{Path(case).name}: checkMesh says Mesh OK.", not wrong, wrong)
    else:
        print("no checkMesh (Debian package openfoam): its verdict is left out")
