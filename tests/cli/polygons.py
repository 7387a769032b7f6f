"""Polygons from files to meshes: columns over triangles, blocks of quads, fields of soups; judged
by VTK, cgnscheck and checkMesh."""

import json
import shutil
import struct
import subprocess
from pathlib import Path

import vtk
from _command import check, check_exit, finish, run, scratch
from _openfoam import judged

USUAL = ("--distance", 0.1, "--first-cell", 0.01, "--layers", 5, "--quiet")


# A box, one corner of one of its triangles pulled in: the hole beside it is as thin as a line.
FOLDED = """v -1 1 1\nv -1 -1 1\nv 1 -1 1\nv -1 -1 -1\nv -1 1 -1\nv 1 1 1\nv 1 1 -1\nv 1 -1 -1
f 1 2 3\nf 4 3 2\nf 1 5 2\nf 5 4 2\nf 8 3 4\nf 7 8 4\nf 5 7 4\nf 7 5 6\nf 7 6 8\nf 6 3 8\nf 5 1 6
v 0.9 0.9 1\nf 9 1 3
"""


def grid_of(file):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def least_volume(grid):
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    return sizes.GetOutput().GetCellData().GetArray("Volume").GetRange()[0]


def cube_obj(file, n, lid=True):
    """Quads of a cube's faces, n x n each, every point once; without a lid open at the top."""
    points, faces = {}, []
    for axis in range(3):
        for end in (0, n):
            if axis == 2 and end == n and not lid:
                continue
            for a in range(n):
                for b in range(n):
                    ring = [(a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)]
                    face = []
                    for u, v in ring if end == n else ring[::-1]:
                        p = [u, v]
                        p.insert(axis, end)
                        if axis == 1:
                            p = [v, end, u]
                        face.append(points.setdefault(tuple(p), len(points) + 1))
                    faces.append(face)
    with open(file, "w") as out:
        out.writelines("v " + " ".join(str(c / n) for c in p) + "\n" for p in points)
        out.writelines("f " + " ".join(map(str, f)) + "\n" for f in faces)


with scratch() as folder:
    folder = Path(folder)
    stl = folder / "torus.stl"
    check_exit("example as STL", run("example", "bumpy-torus", "--points", 17, "-o", stl), 0)
    outputs = {kind: folder / f"t.{kind}" for kind in ("vtu", "cgns", "su2")}
    made = run("mesh", stl, *USUAL, *sum((["-o", f] for f in outputs.values()), []), "-o",
               f"{folder}/case/", "--outer-surface", folder / "outer.stl", "--report",
               folder / "t.json")
    check_exit("columns over triangles", made, 0)
    report = json.loads((folder / "t.json").read_text())
    triangles = 2 * 8 * 16 * 16
    check("a prism for each triangle and layer", report["blocks"]["cells"] == 5 * triangles,
          report["blocks"])
    grid = grid_of(outputs["vtu"])
    check("VTK counts the same cells, all prisms",
          grid.GetNumberOfCells() == 5 * triangles
          and {grid.GetCellType(c) for c in range(grid.GetNumberOfCells())} == {vtk.VTK_WEDGE})
    check("VTK finds their volumes above 0", least_volume(grid) > 0, least_volume(grid))
    for name in ("scaled_jacobian", "block", "layer"):
        check(f"{name} is of every cell", grid.GetCellData().HasArray(name))
    said = json.loads(run("check", "--json", outputs["su2"]).stdout)
    check("check reads the SU2 mesh back: all cells, no faults",
          said["quality"]["cells"] == 5 * triangles and said["faults"] == [], said["faults"])
    again = json.loads(run("check", "--json", outputs["cgns"]).stdout)
    check("and the CGNS mesh as the same", again["faults"] == []
          and all(abs(again["quality"][key] - said["quality"][key])
                  <= 1e-12 * abs(said["quality"][key])
                  for key in ("cells", "min_scaled_jacobian", "nonpositive_cells", "min_volume")),
          again["quality"])
    about = [json.loads(run("info", "--json", outputs[kind]).stdout) for kind in ("cgns", "su2")]
    check("info sees the same points, kinds of cells, and boundaries in both",
          all(about[0][key] == about[1][key] for key in ("points", "cells", "kinds"))
          and [(b["name"], b["faces"]) for b in about[0]["boundaries"]]
          == [(b["name"], b["faces"]) for b in about[1]["boundaries"]], about)
    judged(folder / "case")
    if shutil.which("cgnscheck"):
        told = subprocess.run(["cgnscheck", outputs["cgns"]], capture_output=True, text=True).stdout
        wrong = [line for line in told.splitlines() if "ERROR" in line or "WARNING" in line]
        check("cgnscheck finds nothing", not wrong, wrong)
    check_exit("PLOT3D of columns", run("mesh", stl, *USUAL, "-o", folder / "t.xyz"), 2, "t.xyz",
               "triangles", ".vtu")
    said = run("mesh", stl, *USUAL, "--topology", folder / "t.json", "-o", folder / "t.vtu")
    check_exit("topology of columns", said, 2, "--topology", "triangles")
    check_exit("blocks of triangles", run("mesh", stl, *USUAL, "--polygons", "blocks", "-o",
                                          folder / "t.xyz"), 2, "torus.stl")

    cube = folder / "cube.obj"
    cube_obj(cube, 6)
    check_exit("blocks of quads", run("mesh", cube, *USUAL, "-o", folder / "c.xyz", "--report",
                                      folder / "c.json"), 0)
    report = json.loads((folder / "c.json").read_text())
    check("six patches at most, closed, every quad",
          report["surface"]["patches"] <= 6 and report["blocks"]["cells"] == 5 * 6 * 36,
          report["surface"])
    check_exit("columns of the same", run("mesh", cube, *USUAL, "--polygons", "columns", "-o",
                                          folder / "k.vtu"), 0)
    check("hexahedra, as many", grid_of(folder / "k.vtu").GetNumberOfCells() == 5 * 6 * 36)

    # A lid that hangs in the air across the cube makes edges of three faces.
    soup = folder / "soup.obj"
    soup.write_text(cube.read_text() + "f 1 2 9\n")
    check_exit("layers on a soup", run("mesh", soup, *USUAL, "-o", folder / "s.vtu"), 2, "soup.obj",
               "more than two faces")
    made = run("field", soup, "--distance", 0.1, "-o", folder / "s.vdb")
    check_exit("a field of it", made, 0)
    check("says how sides are told", "winding" in made.stderr, made.stderr)
    check_exit("closed is not to be had", run("field", soup, "--distance", 0.1, "--sign", "closed",
                                              "-o", folder / "s.vdb"), 2, "--sign", "winding")
    cube_obj(folder / "open.obj", 6, lid=False)
    check_exit("an open box is not closed", run("field", folder / "open.obj", "--distance", 0.1,
                                                "--sign", "closed", "-o", folder / "o.vdb"), 2,
               "24 free edges", "the first from (", "winding")
    check_exit("on a plane that it ends on too, for there phi ends",
               run("field", folder / "open.obj", "--distance", 0.1, "--sign", "closed", "--plane",
                   "z=1", "-o", folder / "o.vdb"), 2, "lie on boundaries", "--sign winding")
    for file, plane, sign, why in (
            (cube, (), "normals", "sign: by the normal"),
            (folder / "open.obj", (), "none", "24 free edges; --sign winding"),
            (folder / "open.obj", ("--plane", "z=1"), "none", "24 of its 24 free edges")):
        made = run("field", file, "--distance", 0.1, *plane, "-o", folder / "o.vdb", "--report",
                   folder / "o.json")
        check_exit(f"the sign of {file.name} {plane}", made, 0, "sign: ", why)
        report = json.loads((folder / "o.json").read_text())["field"]
        check("is in the report", report["sign"] == sign, report)
    free = folder / "free.obj"
    cube_obj(free, 2)
    patch = "deg 1 1\nsurf 0 1 0 1 1 2 3 4\nend\n"
    line = free.read_text().count("\n") + 2
    free.write_text(free.read_text() + patch + patch)
    check_exit("free forms beside polygons",
               run("mesh", free, "--distance", 0.2, "--layers", 2, "-o", folder / "f.vtu"), 0,
               "warning", f"free.obj, line {line}", "of 2 in the file", "left out")
    free.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n" + patch)
    check_exit("free forms alone", run("mesh", free, *USUAL, "-o", folder / "f.vtu"), 3,
               "free.obj, line 6", "nothing else")

    one = folder / "one.obj"
    one.write_text("v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n")
    made = run("field", one, "--distance", 0.1, "--sign", "winding", "-o", folder / "o.vdb",
               "--report", folder / "one.json")
    check_exit("a triangle by winding numbers", made, 0, "open (3 free edges)")
    report = json.loads((folder / "one.json").read_text())["surface"]
    check("is not called closed", not report["closed"] and report["free_edges"] == 3, report)

    # The same cube again, half as large and within, as a body and as a hollow.
    lines = cube.read_text().splitlines()
    points = [line.split()[1:] for line in lines if line[0] == "v"]
    faces = [line.split()[1:] for line in lines if line[0] == "f"]
    inner = "".join(f"v {' '.join(str(0.25 + 0.5 * float(x)) for x in p)}\n" for p in points)
    for turn in (1, -1):
        inside = "".join("f " + " ".join(str(int(n) + len(points)) for n in f[::turn]) + "\n"
                         for f in faces)
        nested = folder / "nested.obj"
        nested.write_text(cube.read_text() + inner + "g inner\n" + inside)
        made = run("mesh", nested, *USUAL[:-1], "-o", folder / "n.vtu")
        check_exit("bodies in one another", made, 0)
        said = "closed parts overlap: one of 'inner" in made.stderr
        check("are named" if turn > 0 else "a hollow is none", said == (turn > 0), made.stderr)
    nested.write_text(nested.read_text().replace(inside, "".join(
        "f " + " ".join(str(int(n) + len(points)) for n in f) + "\n" for f in faces)))
    made = run("field", nested, "--distance", 0.1, "-o", folder / "n.vdb")
    check_exit("their sign is explained", made, 0, "sign: by the normal", "--sign winding")
    check_exit("a size of CAD surfaces", run("mesh", cube, *USUAL, "--surface-size", 0, "-o",
                                             folder / "n.vtu"), 2, "--surface-size = 0", "> 0")
    check_exit("without CAD surfaces", run("mesh", cube, *USUAL[:-1], "--surface-size", 1, "-o",
                                           folder / "n.vtu"), 0, "--surface-size", "no effect")
    check_exit("of info", run("info", cube, "--surface-size", 1), 2, "CAD")

    binary = folder / "solid.stl"
    binary.write_bytes(b"solid by a program".ljust(80) + struct.pack("<I", 3)
                       + 2 * (struct.pack("<12f", *([0.0] * 3 + [0, 0, 0, 1, 0, 0, 0, 1, 0]))
                              + bytes(2)))
    check_exit("a binary STL with too high a count", run("info", binary), 3, "counts 3 triangles")
    for sign in ("winding", "unsigned"):
        check_exit(f"an open box, {sign}", run("field", folder / "open.obj", "--distance", 0.1,
                                               "--sign", sign, "-o", folder / "o.vdb"), 0)

    (folder / "folded.obj").write_text(FOLDED)
    folded = ("mesh", folder / "folded.obj", "--distance", 0.1, "--layers", 4, "--first-cell", 0.01)
    outputs = [folder / "f.su2", folder / "f.vtu"]
    made = run(*folded, "-o", outputs[0])
    check_exit("a hole in a face", made, 0, "free edges on no boundary", ": 4, the first from (")
    check("lies on no plane, though its edges do", "ends on" not in made.stderr, made.stderr)
    made = run(*folded, "--plane", "z=1:lid", "-o", outputs[0], "-o", outputs[1], "--report",
               folder / "f.json")
    check_exit("columns around faces without layers, in a plane that is named", made, 0)
    cells = json.loads((folder / "f.json").read_text())["blocks"]["cells"]
    # Two of twelve faces lie in the plane: columns over them would go beyond it.
    check("they have no cells", cells == 10 * 4, cells)
    sound = run("check", outputs[0])
    check("which leave no gap", sound.returncode == 0 and f"{cells} cells\n" in sound.stdout
          and "faults     none" in sound.stdout, sound.stdout)
    check("nor in the .vtu", f'NumberOfCells="{cells}"'.encode() in outputs[1].read_bytes()[:2000])

finish()
