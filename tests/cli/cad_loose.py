"""CAD models with faces of no solid: what is said of those that lie on others, of units, and of
edges that are open."""

import json
from pathlib import Path

from _command import check, check_exit, finish, run, scratch, skip
from _step import Step, cube, flat

with scratch() as folder:
    folder = Path(folder)

    def mesh(name, *more):
        return run("mesh", folder / name, "--surface-size", 0.5, "--distance", 0.2, "--layers", 2,
                   "-o", folder / "a.vtu", *more)

    step = Step()
    step.write(folder / "cube.step", cube(step))
    said = mesh("cube.step")
    if "without OpenCASCADE" in said.stderr:
        skip("built without OpenCASCADE")
    check_exit("a cube of loose faces", said, 0, "closed", "12 edges sewn", "lengths in inches")
    check("nothing is left out", "left out" not in said.stderr, said.stderr)
    check("no word of open edges", "open" not in said.stderr, said.stderr)

    step = Step()
    step.write(folder / "lid.step", cube(step) + [flat(step, "lid", 0, 1, 2)])
    said = mesh("lid.step", "--report", folder / "lid.json")
    check_exit("a face on a face", said, 0, "warning", "lid.step",
               "face 7 'lid' lies on face 2 'roof'", "left out", "closed")
    check("no boundary is made up", "symmetry" not in said.stderr, said.stderr)
    surface = json.loads((folder / "lid.json").read_text())["surface"]
    check("the cube is left", surface["patches"] == 6 and surface["closed"], surface)
    info = json.loads(run("info", "--json", folder / "lid.step").stdout)
    check("info says so", len(info["warnings"]) == 1 and "'lid'" in info["warnings"][0], info)

    step = Step()
    step.write(folder / "over.step", cube(step) + [flat(step, "lid", 1, 3, 2)])
    check_exit("a face that reaches beyond one", mesh("over.step"), 2, "over.step",
               "face 7 'lid' lies on face 2 'roof'", "the rest", "CAD program")

    step = Step()
    step.write(folder / "sheet.step", [flat(step, "sheet", 0, 2, 0)])
    said = run("info", folder / "sheet.step", "--surface-size", 0.5)
    check("a sheet is open", "open, 16 free edges" in said.stdout, said.stdout)
    check("its edges are counted once, as a run has them", "4 edges" not in said.stdout,
          said.stdout)

    step = Step()
    step.write(folder / "tenth.step", cube(step))
    said = run("mesh", folder / "tenth.step", "--scale", .1, "--surface-size", .05, "--distance",
               .02, "--layers", 2, "-o", folder / "a.su2")
    check_exit("lengths of options are scaled ones", said, 0, "96 faces", "before --scale 0.1",
               "edges up to 0.5")
    lines = (folder / "a.su2").read_text().split("NPOIN=")[1].splitlines()
    count = int(lines[0].split()[0])
    points = [[float(x) for x in line.split()[:3]] for line in lines[1:count + 1]]
    bounds = [f(p[n] for p in points) for f in (min, max) for n in range(3)]
    check("as the distance is",
          all(abs(a - b) < 1e-12 for a, b in zip(bounds, [-.02] * 3 + [.22] * 3)), bounds)

    def solid_and(name, *corners):
        step = Step()
        step.write(folder / name, cube(step) + [step.face("fin", corners)])
        return mesh(name)

    check_exit("a sheet within a body",
               solid_and("in.step", (.5, .5, 1), (1.5, .5, 1), (1.5, 1.5, 1), (.5, 1.5, 1)), 0,
               "that of 'fin' lies within that of", "8 triangles", "layers lie in a solid")
    for where, y in ("a face", .9), ("an edge", 0):
        said = solid_and("on.step", (.1, y, 2), (1.9, y, 2), (1.9, y, 3), (.1, y, 3)).stderr
        check(f"a sheet on {where} is named",
              "that of 'fin' stands on 'roof' (4 edges" in said and "layers do not join" in said,
              said)
    said = solid_and("off.step", (.1, 1, 2.1), (1.9, 1, 2.1), (1.9, 1, 3), (.1, 1, 3))
    check("a sheet beside a body is none of these", "open parts do not" not in said.stderr,
          said.stderr)

finish()
