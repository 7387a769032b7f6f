"""CAD models that OpenCASCADE takes in silence: faces that it drops, numbers that are none, edges
off their surfaces, gaps that welding closes."""

import json
import re
import time
from pathlib import Path

from _command import check, check_exit, finish, run, scratch, skip
from _step import Step, cube

with scratch() as folder:
    folder = Path(folder)

    def mesh(name, *more):
        return run("mesh", folder / name, "--surface-size", 0.5, "--distance", 0.2, "--layers", 2,
                   "-o", folder / "a.su2", *more)

    def changed(name, old, new):
        text = (folder / "closed.step").read_text()
        assert re.search(old, text), old
        (folder / name).write_text(re.sub(old, new, text, count=1))

    step = Step()
    step.write(folder / "gaps.step", cube(step, gap=1e-4, inward=True))
    said = mesh("gaps.step")
    if "without OpenCASCADE" in said.stderr:
        skip("built without OpenCASCADE")
    check_exit("a cube of loose faces that welding closes", said, 0, "closed", "outward")
    text = (folder / "a.su2").read_text()
    points = re.search(r"NPOIN= *(\d+).*?\n((?:.*\n)*)", text)
    lines = points[2].splitlines()[:int(points[1])]
    numbers = [float(x) for line in lines for x in line.split()[:3]]
    check("its layers are outside", abs(min(numbers) + 0.2) < 0.01
          and abs(max(numbers) - 2.2) < 0.01, (min(numbers), max(numbers)))

    step = Step()
    step.write(folder / "closed.step", cube(step), closed=True)
    said = mesh("closed.step")
    check_exit("a closed shell", said, 0, "closed")
    check("there is nothing to warn of", "warning" not in said.stderr, said.stderr)

    changed("surface.step", r"PLANE\(", "PLAIN(")
    face = re.search(r"(#\d+)=ADVANCED_FACE", (folder / "closed.step").read_text())[1]
    said = mesh("surface.step")
    check_exit("a face of an unknown surface", said, 0, "warning", f"face {face} (", "left out",
               "its closed shell #", "comes out open: 4 edges")
    info = json.loads(run("info", "--json", folder / "surface.step").stdout)
    check("info warns too", len(info["warnings"]) == 2, info["warnings"])
    changed("dangling.step", r"(CLOSED_SHELL\('',\()#\d+,", r"\1#99999,")
    check_exit("a face that there is not", mesh("dangling.step"), 0, "warning", "face 1 of 6",
               "left out", "comes out open: 4 edges")

    for n, number in enumerate(("NAN", "-nan(ind)", "1.#QNAN", "1.E400", "-1E+200")):
        changed(f"none{n}.step", r"#1=CARTESIAN_POINT\('',\([^,]*,",
                rf"#1=CARTESIAN_POINT('',({number},")
        start = time.monotonic()
        said = mesh(f"none{n}.step")
        check_exit(f"the number {number}", said, 3, f"none{n}.step", "line 8", "#1:", "no number")
        check("is refused at once", time.monotonic() - start < 30)
    changed("quoted.step", "'floor'", "'NaN''inf /* 1.E400'")
    check_exit("none of these is a number", mesh("quoted.step"), 0, "closed")

    step = Step()
    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
    step.write(folder / "off.step", [step.face("floor", corners, off=0.02)])
    said = mesh("off.step")
    check_exit("edges off their plane", said, 0, "warning", "face 1 'floor'", "by 0.02 at")
finish()
