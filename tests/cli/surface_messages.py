"""What is said about surfaces that are wrong, or that were turned round."""

import json
import math
from pathlib import Path

from _command import check, check_exit, finish, run, scratch


def plate(ni, nj, origin=(0, 0), turned=False, size=1.0):
    """x, y and z of a flat patch, i fastest."""
    i_of = [(ni - 1 - i) if turned else i for i in range(ni)]
    points = [(origin[0] + size * i / (ni - 1), origin[1] + size * j / (nj - 1), 0.0)
              for j in range(nj) for i in i_of]
    return (ni, nj, points)


def write(file, patches):
    lines = [str(len(patches))] + [f"{ni} {nj} 1" for ni, nj, _ in patches]
    for _, _, points in patches:
        lines += [" ".join(repr(p[axis]) for p in points) for axis in range(3)]
    file.write_text("\n".join(lines) + "\n")


with scratch() as folder:
    folder = Path(folder)

    def mesh(*arguments):
        return run("mesh", *arguments, "--distance", 0.2, "--layers", 2, cwd=folder)

    write(folder / "uneven.fmt", [plate(5, 5), plate(5, 4, (1, 0))])
    check_exit("sides of 5 and 4 points", mesh("uneven.fmt", "-o", "a.fmt"), 2, "do not match",
               "side imax of patch 1", "(5 points)", "side imin of patch 2", "(4 points)",
               "uneven.fmt")
    write(folder / "corner.fmt", [plate(5, 5), plate(5, 4, (1, 1))])
    check_exit("two plates that touch in a corner", mesh("corner.fmt", "-o", "a.fmt"), 2,
               "single node", "corner.fmt")

    far = plate(3, 3)
    far[2][4] = (0.5, 1e300, 0.0)
    write(folder / "far.fmt", [plate(3, 3), far])
    check_exit("a coordinate of 1e300", mesh("far.fmt", "-o", "a.fmt"), 2, "far.fmt", "1e+300",
               "patch 2", "(2, 2)")
    write(folder / "flat.fmt", [(3, 3, [(i * 1.0, 0.0, 0.0) for _ in range(3) for i in range(3)])])
    write(folder / "dot.fmt", [(3, 3, [(1.0, 2.0, 3.0)] * 9)])
    for name in ["flat.fmt", "dot.fmt"]:
        check_exit(f"a surface without area, {name}", mesh(name, "-o", "a.fmt"), 2, name)
        check_exit(f"info of it, {name}", run("info", name, cwd=folder), 2, name)

    crossed = plate(4, 4)
    crossed[2][5], crossed[2][6] = crossed[2][6], crossed[2][5]
    write(folder / "crossed.fmt", [plate(4, 4, (1, 0)), crossed])
    for more in ((), ("--dry-run",)):
        made = mesh("crossed.fmt", "-o", "a.fmt", *more)
        check_exit(f"quads that cross themselves {more}", made, 2, "2 quads", "patch 2",
                   "point (2, 1)", "crossed.fmt", "bow tie")
        check("before the run", "march" not in made.stderr, made.stderr)
    check_exit("field takes them", run("field", "crossed.fmt", "--distance", 0.2, "-o", "a.vdb",
                                       cwd=folder), 0)
    eight = [(math.sin(a), math.sin(a) * math.cos(a), 0.0)
             for a in (2 * math.pi * (n + 0.5) / 20 for n in range(20))]
    write(folder / "eight.fmt", [(21, 1, eight + eight[:1])])
    for more in ((), ("--dry-run",)):
        check_exit(f"a curve that crosses itself {more}", mesh("eight.fmt", "-o", "a.fmt", *more),
                   2, "a curve crosses itself", "between points 10 and 11",
                   "between points 20 and 21", "eight.fmt")
    check_exit("field takes it", run("field", "eight.fmt", "--distance", 0.2, "-o", "a.vdb",
                                     cwd=folder), 0)
    lines = [[(0.25 * n * x, 0.25 * n * y, 0.0) for n in range(5)]
             for x, y in ((1, 0), (-1, 1), (-1, -1))]
    write(folder / "star.fmt", [(5, 1, line) for line in lines])
    star = mesh("star.fmt", "-o", "a.fmt")
    check_exit("three curves from one point", star, 2, "3 segments of curves meet in one point",
               "patch 2", "point 1 at (0, 0)", "star.fmt")
    check("without edges, j and z",
          not any(word in star.stderr for word in ("edge", "(1, 1)", "(0, 0, 0)")), star.stderr)
    (folder / "bow.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                                    "f 1 2 3 4\nf 2 5 3 6\n")
    for polygons in ("auto", "columns"):
        check_exit(f"a quad of a file of polygons, {polygons}",
                   mesh("bow.obj", "--polygons", polygons, "-o", "a.vtu"), 2, "bow.obj", "face 2",
                   "bow tie", "exchange")
    check("info has it", "faces that cross themselves" in run("info", "bow.obj",
                                                              cwd=folder).stdout)

    check_exit("example", run("example", "quarter-cylinder", "--points", 9, "-o", "quarter.xyz",
                              cwd=folder), 0)
    check_exit("field of a surface that ends on planes",
               run("field", "quarter.xyz", "--plane", "x=0", "--plane", "y=0", "--distance", 0.2,
                   "-o", "a.vdb", cwd=folder), 0, "sign: none", "lie on boundaries",
               "--sign winding")
    check_exit("without them winding numbers do",
               run("field", "quarter.xyz", "--sign", "winding", "--distance", 0.2, "-o", "a.vdb",
                   "--report", "a.json", cwd=folder), 0)
    check("and say so", json.loads((folder / "a.json").read_text())["field"]["sign"] == "winding")

    turned = [plate(3, 3, (x, 0), turned=x % 2 == 1) for x in range(20)]
    write(folder / "turned.fmt", turned)
    made = mesh("turned.fmt", "-o", "b.fmt", "--report", "b.json")
    check_exit("every second patch is turned", made, 0, "10 of 20 patches turned round", "patch 2",
               "and 4 more")
    lines = [line for line in made.stderr.splitlines() if "turned round" in line]
    check("in one line", len(lines) == 1, made.stderr)
    check("the report names them all", json.loads((folder / "b.json").read_text())["surface"][
        "flipped"] == [f"patch {n}" for n in range(2, 21, 2)])
    made = mesh("turned.fmt", "-o", "b.fmt", "--verbose")
    check("--verbose names them all", "patch 20" in made.stderr, made.stderr)
    made = mesh("turned.fmt", "-o", "b.fmt", "--quiet")
    check("--quiet names none", "turned" not in made.stderr, made.stderr)
    write(folder / "agree.fmt", [plate(3, 3, (x, 0)) for x in range(3)])
    made = mesh("agree.fmt", "-o", "b.fmt")
    check("no word where none was turned", "turned" not in made.stderr, made.stderr)

    short = mesh("agree.fmt", "-o", "c.fmt", "--max-sweeps", 1, "--report", "c.json")
    check_exit("one sweep", short, 4, "after 1 sweep:", "for the first time", "--max-sweeps")
    check("no absurd number", "e+2" not in short.stderr and "e+3" not in short.stderr, short.stderr)
    check("nor in the report",
          json.loads((folder / "c.json").read_text())["field"]["last_change_voxels"] is None)

finish()
