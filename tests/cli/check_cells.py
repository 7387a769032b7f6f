"""check and info of SU2, OpenFOAM and VTK files: those that we write come back as they were."""

import json
import re
import shutil
import struct
from pathlib import Path

import numpy as np

from _command import check, check_exit, finish, run, scratch

USUAL = ("--distance", 0.05, "--first-cell", 0.01, "--layers", 3, "--quiet")
CURVES = ("airfoil", "circle")


def su2_points(file):
    lines = file.read_text().splitlines()
    at = next(n for n, line in enumerate(lines) if line.startswith("NPOIN="))
    count = int(lines[at].split("=")[1])
    return [tuple(map(float, line.split())) for line in lines[at + 1:at + 1 + count]]


def foam_points(case):
    text = (case / "constant/polyMesh/points").read_text()
    found = re.findall(r"^\((\S+) (\S+) (\S+)\)$", text, re.M)
    return [tuple(map(float, point)) for point in found]


def plot3d_points(file):
    """Of unformatted blocks in three dimensions."""
    data = file.read_bytes()
    count = struct.unpack_from("<i", data, 4)[0]
    sizes = np.frombuffer(data, "<i4", 3 * count, 16).reshape(count, 3)
    at, out = 12 + 8 + 12 * count, set()
    for size in sizes:
        n = int(np.prod(size))
        xyz = np.frombuffer(data, "<f8", 3 * n, at + 4).reshape(3, n).T
        out |= {tuple(p) for p in xyz.tolist()}
        at += 24 * n + 8
    return out


def judged(file, claim, exits=(0,)):
    said = run("check", "--json", file)
    check_exit(f"{claim}: check", said, said.returncode if said.returncode in exits else exits[0])
    return json.loads(said.stdout)


with scratch() as folder:
    folder = Path(folder)
    cases = (("cube", ()), ("cube", ("--fans", 2)), ("star", ("--fans", 2)), ("sphere", ()),
             ("cube", ("--side", "both")), ("quarter-cylinder", ()), ("channel", ()),
             ("airfoil", ()), ("circle", ()))
    for name, options in cases:
        title = " ".join((name, *map(str, options)))
        surface = folder / f"{name}{'.xyz' if name in CURVES else '.cgns'}"
        check_exit(f"example {name}", run("example", name, "-o", surface, "--points", 9), 0)
        case = folder / "case"
        shutil.rmtree(case, ignore_errors=True)
        su2, plot3d, report = folder / "m.su2", folder / "m.p3d", folder / "m.json"
        made = run("mesh", surface, "-o", su2, "-o", plot3d, "-o", f"{case}/", "-o",
                   folder / "m.vtm", "-o", folder / "m.vtu", "--report", report, *USUAL, *options)
        check_exit(f"mesh {title}", made, 0)
        told = json.loads(report.read_text())
        cells, worst = told["blocks"]["cells"], told["quality"]["min_scaled_jacobian"]

        foam = judged(f"{case}/", f"{title}, OpenFOAM")
        check(f"{title}, OpenFOAM: all cells", foam["quality"]["cells"] == cells,
              foam["quality"]["cells"])
        odd = foam["kinds"].get("polyhedra", {"cells": 0})["cells"]
        native = judged(su2, f"{title}, SU2")
        check(f"{title}, SU2: no faults", native["faults"] == [], native["faults"])
        parted = native["kinds"].get("pyramids", {"cells": 0})["cells"] > 0
        check(f"{title}, SU2: all cells, and more only where some are parted",
              native["quality"]["cells"] == cells if not odd
              else native["quality"]["cells"] > cells and parted, native["kinds"])
        zones = judged(folder / "m.vtm", f"{title}, VTK")
        check(f"{title}, VTK: all cells, the same scaled Jacobian",
              zones["quality"]["cells"] == cells
              and abs(zones["quality"]["min_scaled_jacobian"] - worst) < 1e-12, zones["quality"])
        check(f"{title}, VTK: interfaces are found again", zones["connectivity"]["known"]
              and zones["connectivity"]["interfaces"] == told["blocks"]["interfaces"]
              and zones["faults"] == [], zones["connectivity"])
        grid = judged(folder / "m.vtu", f"{title}, VTK unstructured")
        check(f"{title}, VTK unstructured: all cells, the same scaled Jacobian, no faults",
              grid["quality"]["cells"] == cells and grid["faults"] == []
              and abs(grid["quality"]["min_scaled_jacobian"] - worst) < 1e-12, grid)
        thin = grid["faces"]["coincident_pairs"]
        check(f"{title}, VTK unstructured: walls of two sides are told, and no others",
              thin == (6 * 8 * 8 if "both" in options else 0), thin)
        if not odd:
            for what, found in (("OpenFOAM", foam), ("SU2", native)):
                check(f"{title}, {what}: the least scaled Jacobian is the blocks'",
                      abs(found["quality"]["min_scaled_jacobian"] - worst) < 1e-12,
                      (found["quality"]["min_scaled_jacobian"], worst))
                check(f"{title}, {what}: the mean too",
                      abs(found["quality"]["mean_scaled_jacobian"]
                          - told["quality"]["mean_scaled_jacobian"]) < 1e-9)
        check(f"{title}: faces are as many in both",
              odd or name in CURVES or native["faces"] == foam["faces"],
              (native["faces"], foam["faces"]))
        if name in CURVES:
            check(f"{title}: two dimensions", native["flat"] and "flat" in native, native["flat"])
            continue
        points = su2_points(su2)
        held = foam_points(case)
        check(f"{title}: points in the same order, bit for bit", points[:len(held)] == held)
        check(f"{title}: they are the blocks', bit for bit", set(held) == plot3d_points(plot3d))

    said = run("info", su2)
    check_exit("info of SU2", said, 0)
    check("it names its boundaries", "outer" in said.stdout and "two dimensions" in said.stdout,
          said.stdout)
    said = json.loads(run("info", "--json", case).stdout)
    check("info of a case", said["format"] == "openfoam" and "empty" in
          {b["type"] for b in said["boundaries"]}, said)
    said = json.loads(run("info", "--json", folder / "m.vtm").stdout)
    check("info of VTK", (said["format"], len(said["blocks"])) == ("vtk", 1), said)
    said = json.loads(run("info", "--json", folder / "m.vtu").stdout)
    check("info of VTK unstructured", said["format"] == "vtu"
          and said["kinds"] == {"hexahedra": said["cells"]} and said["boundaries"] == [], said)
    said = run("info", folder / "m.vtu")
    check("the same as text", "hexahedra" in said.stdout and "unstructured" in said.stdout,
          said.stdout)
    said = run("check", folder / "m.vtu")
    check("check says that it names no boundaries", "names no boundaries" in said.stdout,
          said.stdout)
    check_exit("info of nothing", run("info", folder / "none.su2"), 3, "none.su2", "not exist")

    text = su2.read_text()
    su2.write_text("\n".join(line for line in text.splitlines()
                             if not line.startswith("MARKER_TAG= outer")).replace(
                                 f"NMARK= {text.count('MARKER_TAG')}", "NMARK= 1"))
    check("a marker without its tag is refused, or its faces are missed",
          run("check", su2).returncode in (1, 3))
    su2.write_text(text.replace("NELEM= ", "NELEM= 9", 1))
    check_exit("more elements than there are", run("check", su2), 3, "m.su2", "line")
    case_points = case / "constant/polyMesh/points"
    case_points.write_text(case_points.read_text().replace("ascii", "binary"))
    check_exit("a binary case", run("check", case), 3, "points", "binary", "ascii")
    check_exit("a folder without a mesh", run("check", folder), 3, "no case of OpenFOAM")
    check_exit("a surface of cells", run("mesh", folder / "m.vtu", "-o", folder / "n.p3d", *USUAL),
               2, "volume mesh")
    check_exit("a surface of it", run("mesh", folder / "m.vtm", "-o", folder / "n.p3d", *USUAL), 2,
               "volume mesh")
    check_exit("a cube", run("example", "cube", "-o", folder / "cube.cgns", "--points", 5), 0)
    vtm, vts = folder / "m.vtm", folder / "m" / "block_0.vts"
    made = run("mesh", folder / "cube.cgns", "-o", vtm, *USUAL)
    check_exit("as VTK", made, 0)
    index, whole = vtm.read_text(), vts.read_bytes()

    def vtk_faults():
        said = run("check", "--json", vtm)
        found = json.loads(said.stdout)
        return said.returncode, {fault["kind"] for fault in found["faults"]}, found["faults"]

    check("a cube in VTK is sound", vtk_faults() == (0, set(), []))
    data = bytearray(whole)
    place = data.index(b"_", data.index(b"<AppendedData")) + 1 + 8 + 8 * 3 * 2
    data[place:place + 8] = struct.pack("=d", struct.unpack_from("=d", data, place)[0] + 1e-9)
    vts.write_bytes(data)
    code, kinds, faults = vtk_faults()
    check("a point of the wall moved by a billionth: its boundary is no part of the block",
          code == 1 and "unreadable" in kinds and "uncovered" in kinds, faults)
    vts.write_bytes(whole)
    vtm.write_text(index.replace('name="y min"', 'name="boundaries"'))
    check("a block may be called as the group of boundaries is", vtk_faults() == (0, set(), []),
          vtk_faults())
    lines = index.splitlines(keepends=True)
    vtm.write_text("".join(line for line in lines if "block_0_face_1" not in line))
    code, kinds, faults = vtk_faults()
    check("a boundary that is left out", code == 1 and kinds == {"uncovered"}
          and sum(fault["faces"] for fault in faults) == 16, faults)
    vtm.write_text("".join(line for line in lines if "block_5" not in line))
    code, kinds, faults = vtk_faults()
    check("a block that is left out", code == 1 and kinds == {"uncovered"}, faults)
    vtm.write_text(index[:len(index) // 2])
    check_exit("an index that is cut", run("check", vtm), 3, "m.vtm", "</VTKFile>")
    vtm.write_text(index.replace("block_0_face_0", "block_1_face_0"))
    code, kinds, faults = vtk_faults()
    check("a boundary twice", code == 1 and kinds == {"uncovered", "doubly-covered"}, faults)
    vtm.write_text(index)
    vts.write_bytes(whole[:len(whole) // 4])
    check_exit("a piece that is cut", run("check", folder / "m.vtm"), 3, "block_0.vts")

finish()
