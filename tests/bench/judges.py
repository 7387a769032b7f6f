#!/usr/bin/python3
"""Every example and real surface in every format, before each judge there is.

    judges.py [--only SUBSTRING] [--real] [--keep DIR]

A mesh is written as CGNS, OpenFOAM, VTK (.vtm, .vts, .vtu), SU2 and PLOT3D with its map. `check`
reads each, and finds no fault; cgnscheck has nothing to say; checkMesh says "Mesh OK."; VTK's own
readers count the same points and cells, and the same bytes in PLOT3D. Prints a line a mesh, and
what is wrong. Exits 1 if anything is.

With --real, surfaces of the shared data (VDB_OFFSET_SHARED_DATA) at viscous spacings, of which
checkMesh may refuse aspect ratios alone. Needs the command (VDB_OFFSET), python3-vtk9, cgns-convert
and openfoam.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from _command import COMMAND, DATA  # noqa: E402
from _vtk import blocks, np, vtk, vtk_to_numpy  # noqa: E402

CURVES = {"airfoil", "circle"}
# Distance, first cell and layers that keep aspect ratios below LIMIT on 9 points a side, 17 on
# wings.
USUAL = ("--distance", 0.05, "--first-cell", 0.005, "--layers", 5)
THICKER = ("--distance", 0.15, "--first-cell", 0.015, "--layers", 5)
LARGE = {"fuselage", "torus", "sphere", "sphere-pair", "draft-tube"}
FURTHER = {"star": ("--fans", 2)}  # its tips are too sharp for one cell
LIMIT = 500  # of aspect ratios
REAL = {"corner": ("cgns/pyhyp_corner.cgns", ("--distance", 0.3, "--layers", 16)),
        "717": ("cgns/717_wl_L2.cgns", ("--distance", 0.2, "--layers", 16)),
        "m6": ("plot3d/m6_small.fmt", ("--distance", 0.1, "--layers", 64, "--first-cell", 1e-5)),
        "bwb": ("plot3d/bwb.fmt", ("--distance", 2, "--layers", 64, "--first-cell", 1e-4))}
ASPECT = re.compile(r"aspect ratio", re.I)


def run(*arguments, cwd=None, env=None):
    return subprocess.run([str(a) for a in arguments], cwd=cwd, env=env, capture_output=True,
                          text=True, errors="replace")


def by_check(file):
    """Cells, faults and bad cells by `check`, and the largest aspect ratio."""
    said = run(COMMAND, "check", "--json", file)
    try:
        found = json.loads(said.stdout)
    except json.JSONDecodeError:
        return 0, [said.stderr.strip()], 0
    quality = found["quality"]
    wrong = [fault["text"] for fault in found["faults"]]
    if quality["nonpositive_cells"]:
        wrong.append(f"{quality['nonpositive_cells']} cells not positive")
    return quality["cells"], wrong, quality["max_aspect_ratio"]


def by_cgnscheck(file):
    said = run("cgnscheck", "-v", file).stdout
    wrong = re.findall(r"^.*(?:ERROR|WARNING).*$", said, re.M)
    return wrong if "checking complete" in said else wrong + ["it did not finish"]


def by_check_mesh(case, viscous):
    said = run("checkMesh", "-constant", "-allTopology", cwd=case,
               env={**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"})
    text = said.stdout + said.stderr
    wrong = re.findall(r"^ *\*\*.*$|^.*FATAL.*$", text, re.M)
    if viscous:
        return [line for line in wrong if not ASPECT.search(line)]
    return wrong if "Mesh OK." in text else wrong + ["no 'Mesh OK.'"]


def counts(data):
    """Points and cells of a grid of VTK, or of all in a composite one."""
    if not data.IsA("vtkCompositeDataSet"):
        return np.array([data.GetNumberOfPoints(), data.GetNumberOfCells()])
    at = data.NewIterator()
    total = np.zeros(2, int)
    while not at.IsDoneWithTraversal():
        total += counts(at.GetCurrentDataObject())
        at.GoToNextItem()
    return total


def read(reader, file):
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def by_vtk(folder, cells, flat):
    wrong = []

    def expect(name, found, meant):
        if not np.array_equal(found, meant):
            wrong.append(f"VTK counts {found} in {name}, not {meant}")

    grids = blocks(folder / "m.vtm")
    points = sum(grid.GetNumberOfPoints() for grid in grids)
    expect(".vtm", sum(grid.GetNumberOfCells() for grid in grids), cells)
    expect(".vtu", counts(read(vtk.vtkXMLUnstructuredGridReader(), folder / "m.vtu"))[1], cells)
    if not flat:
        expect("CGNS", counts(read(vtk.vtkCGNSReader(), folder / "m.cgns")), (points, cells))
    (folder / "case/any.foam").touch()
    foam = vtk.vtkOpenFOAMReader()
    foam.SetFileName(str(folder / "case/any.foam"))
    foam.DecomposePolyhedraOff()
    foam.Update()
    expect("OpenFOAM", counts(foam.GetOutput().GetBlock(0))[1], cells)
    if flat:
        return wrong
    reader = vtk.vtkMultiBlockPLOT3DReader()
    reader.SetXYZFileName(str(folder / "m.xyz"))
    reader.AutoDetectFormatOn()
    reader.Update()
    back = reader.GetOutput()
    expect("PLOT3D", counts(back), (points, cells))
    for b, grid in enumerate(grids):
        ours = vtk_to_numpy(grid.GetPoints().GetData())
        theirs = vtk_to_numpy(back.GetBlock(b).GetPoints().GetData())
        if ours.shape != theirs.shape or ours.astype(theirs.dtype).tobytes() != theirs.tobytes():
            wrong.append(f"VTK's PLOT3D reader has other points in block {b}")
    return wrong


def judge(name, surface, options, folder, viscous=False):
    flat = name in CURVES
    files = [folder / f"m.{kind}" for kind in ("cgns", "vtm", "vtu", "su2", "xyz", "nmf")]
    if flat:
        files.pop()
    outputs = [word for file in (*files, f"{folder / 'case'}/") for word in ("-o", file)]
    made = run(COMMAND, "mesh", surface, *options, *outputs, "--quiet", "--report",
               folder / "m.json")
    if made.returncode != 0:
        return [f"mesh: exit {made.returncode}: {made.stderr.strip()}"], "", 0
    told = json.loads((folder / "m.json").read_text())
    cells, wrong, aspect = told["blocks"]["cells"], [], 0
    odd = []
    for file in (*files[:5], folder / "case"):
        found, faults, aspect_here = by_check(file)
        wrong += [f"check of {file.name}: {fault}" for fault in faults]
        aspect = max(aspect, aspect_here)
        if found != cells:
            (odd if file.suffix == ".su2" else wrong).append(
                f"{file.name} has {found} cells, not {cells}")
    wrong += [f"cgnscheck: {line}" for line in by_cgnscheck(files[0])]
    wrong += [f"checkMesh: {line}" for line in by_check_mesh(folder / "case", viscous)]
    wrong += by_vtk(folder, cells, flat)
    if aspect >= LIMIT and not viscous:
        wrong.append(f"aspect ratio {aspect}, not below {LIMIT}")
    return wrong, "; ".join(odd), f"{cells:8} cells, aspect ratio {aspect:9.4g}"


def surfaces(real, folder):
    """Name, file, options."""
    if real:
        for name, (file, options) in REAL.items():
            if (DATA / file).exists():
                yield name, DATA / file, options
            else:
                print(f"{name:24} skipped: {DATA / file} is not there")
        return
    names = [line.split()[0] for line in run(COMMAND, "example").stdout.splitlines()]
    for name in (*names, "draft-tube --closed"):
        stem = name.split()[0]
        file = folder / f"{name.replace(' ', '')}.{'xyz' if stem in CURVES else 'cgns'}"
        made = run(COMMAND, "example", *name.split(), "-o", file, "--points",
                   17 if "wing" in name else 9)
        if made.returncode != 0:
            sys.exit(f"example {name}: {made.stderr}")
        yield name, file, (*(THICKER if stem in LARGE else USUAL), *FURTHER.get(stem, ()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="")
    parser.add_argument("--real", action="store_true")
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    failed = ran = 0
    with tempfile.TemporaryDirectory() as scratch:
        top = given.keep or Path(scratch)
        top.mkdir(parents=True, exist_ok=True)
        for name, file, options in surfaces(given.real, top):
            if given.only not in name:
                continue
            folder = top / f"{name.replace(' ', '')}-mesh"
            folder.mkdir(exist_ok=True)
            wrong, odd, told = judge(name, file, options, folder, given.real)
            ran += 1
            failed += bool(wrong)
            print(f"{name:24} {'FAIL' if wrong else 'ok'}  {told}  {odd}", flush=True)
            for line in wrong[:20]:
                print(f"    {line}")
    print(f"{ran - failed} passed, {failed} failed")
    sys.exit(1 if failed or ran == 0 else 0)


main()
