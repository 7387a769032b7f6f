"""Internal surfaces that columns end on: boundary faces of their name, in every format."""

import json
import re
import shutil
import subprocess
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch
from _openfoam import judged, patches
from _vtk import blocks, boundaries, np, point_data, points

HIGH, LOW = 0.9, 0.1  # planes z: above all of the one, below the upper wall, which is at 1
LAYERS = 4


def sheet(file, x, y, z, ni=9, nj=5):
    px, py = np.meshgrid(np.linspace(*x, ni), np.linspace(*y, nj))
    values = np.concatenate([px.ravel(), py.ravel(), np.full(px.size, z)])
    file.write_text(f"1\n{ni} {nj} 1\n" + "\n".join(map(repr, values.tolist())) + "\n")
    return file


def faces_on(grids, name):
    """How many faces of a block's last level have all corners on a plane, by stop and place."""
    place = {"roof": HIGH, "disk": LOW}[name]
    count = 0
    for grid in grids:
        near = np.abs(points(grid)[-1][..., 2] - place) < 1e-12
        on = near & (point_data(grid, "stop")[-1] == 4)
        count += int((on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:]).sum())
    return count


def cgns_complaints(file):
    said = subprocess.run(["cgnscheck", "-v", file], capture_output=True, text=True).stdout
    wrong = re.findall(r"^.*(?:ERROR|WARNING).*$", said, re.M)
    return wrong if "checking complete" in said else ["did not finish"]


def markers(file):
    return {name: int(count) for name, count in re.findall(
        r"MARKER_TAG= (\S+)\nMARKER_ELEMS= (\d+)", file.read_text())}


def judge_vtm(title, folder):
    """What VTK reads; the faces that each internal surface is meant to have."""
    grids, groups = blocks(folder / "out.vtm"), boundaries(folder / "out.vtm")
    meant = {name: faces_on(grids, name) for name in ("roof", "disk")}
    cells = {name: sum(g.GetNumberOfCells() for g in group) for name, group in groups.items()}
    level = sum((g.GetDimensions()[0] - 1) * (g.GetDimensions()[1] - 1) for g in grids)
    check(f"{title}: columns end on both", min(meant.values()) > 0, meant)
    check(f"{title}: faces whose columns all end on one have its name, all others outer",
          {name: cells.get(name) for name in meant} == meant
          and cells["outer"] == level - sum(meant.values()), (cells, meant, level))
    for name, place in (("roof", HIGH), ("disk", LOW)):
        off = max(np.abs(points(g)[..., 2] - place).max() for g in groups[name])
        check(f"{title}: {name} lies on its surface", off < 1e-12, off)
    return grids, meant


def judge_blocks(title, folder, *options):
    outputs = [part for name in ("out.cgns", "out.vtm", "out.xyz", "out.su2", "out.nmf",
                                           "case/")
               for part in ("-o", f"{folder / name}{'/' if name.endswith('/') else ''}")]
    made = run("mesh", folder / "channel.cgns", *USUAL, *sheets(folder), *outputs, "--topology",
               folder / "out.json", "--report",
               folder / "report.json", "--outer-surface", folder / "outer.obj", *options)
    check_exit(f"{title}: mesh", made, 0)
    grids, meant = judge_vtm(title, folder)
    judge_files(title, folder, meant)
    judge_outer(title, folder, grids)
    for name, further in (("out.cgns", ()), ("out.vtm", ()), ("out.su2", ()), ("case", ()),
                          ("out.xyz", ("--nmf", folder / "out.nmf"))):
        said = run("check", folder / name, *further)
        check_exit(f"{title}: check {name}", said, 0)
    return grids


def judge_files(title, folder, meant):
    found = markers(folder / "out.su2")
    check(f"{title}: SU2 has a marker for each", {n: found.get(n) for n in meant} == meant, found)
    found = patches(folder / "case")
    check(f"{title}: OpenFOAM has a patch for each",
          {n: found[n][:2] for n in meant} == {n: ("patch", meant[n]) for n in meant}, found)
    judged(folder / "case")
    held = json.loads((folder / "report.json").read_text())["blocks"]
    check(f"{title}: the report names them", {"roof", "disk"} <= set(held["named_faces"])
          and (held["conditions"]["roof"], held["conditions"]["disk"])
          == ("unspecified", "outflow"), held)
    if shutil.which("cgnscheck"):
        said = cgns_complaints(folder / "out.cgns")
        check(f"{title}: cgnscheck finds nothing", not said, "\n".join(said[:9]))
    said = json.loads(run("info", "--json", folder / "out.cgns").stdout)
    types = {family["name"]: family["type"] for family in said["families"]}
    check(f"{title}: CGNS has a family for each", "roof" in types
          and types["disk"] == "BCOutflow", types)
    lines = (folder / "out.nmf").read_text().splitlines()
    rows = [line.split() for line in lines if line.startswith("OUTFLOW")]
    area = sum((int(r[4]) - int(r[3])) * (int(r[6]) - int(r[5])) for r in rows)
    check(f"{title}: the neutral map has the disk's ranges", area == meant["disk"], rows)


def judge_outer(title, folder, grids):
    rows = [line.split() for line in (folder / "outer.obj").read_text().splitlines()]
    faces = sum(1 for row in rows if row and row[0] == "f")
    level = sum((g.GetDimensions()[0] - 1) * (g.GetDimensions()[1] - 1) for g in grids)
    check(f"{title}: the outer surface is the whole level", faces == level, (faces, level))


def judge_topology(folder):
    held = json.loads((folder / "out.json").read_text())
    parts = held["boundary_faces"]
    for n, face in enumerate(held["faces"]):
        if face["kind"] == "side" and face["boundary_face"] >= 0:
            at = parts[face["boundary_face"]]["range"]["face"]
            check(f"topology: face {n} is a side", at not in ("kmin", "kmax"), at)
    for b, block in enumerate(held["blocks"]):
        for side in ("kmin", "kmax"):
            first = held["faces"][block["faces"][side][0]]["boundary_face"]
            mine = [n for n, part in enumerate(parts)
                    if part["range"]["block"] == b and part["range"]["face"] == side]
            check(f"topology: block {b}, {side}: the first of its parts, which follow one another",
                  mine == list(range(first, first + len(mine))) and mine, (first, mine))
    named = {part["name"] for part in parts if part["range"]["face"] == "kmax"}
    check("topology: outermost levels are parted", named == {"outer", "roof", "disk"}, named)
    made = run("mesh", folder / "out.json", *USUAL, "-o", folder / "again.xyz", "--topology",
               folder / "again.json", "--bc", "disk:outflow")
    check_exit("mesh of the topology", made, 0)
    for one, other in (("out.xyz", "again.xyz"), ("out.json", "again.json")):
        check(f"{other} is {one}, bit for bit",
              (folder / one).read_bytes() == (folder / other).read_bytes())


def judge_polygons(folder):
    check_exit("example as STL", run("example", "channel", "--points", 9, "-o",
                                     folder / "channel.stl"), 0)
    made = run("mesh", folder / "channel.stl", *USUAL, *sheets(folder), "-o", folder / "poly.su2",
               "-o", f"{folder / 'poly'}/", "-o", folder / "poly.cgns", "--report",
               folder / "poly.json")
    check_exit("columns over polygons: mesh", made, 0)
    found, foam = markers(folder / "poly.su2"), patches(folder / "poly")
    check("columns over polygons: markers and patches of both names, as many faces in each",
          all(found.get(name, 0) > 0 and found[name] == foam[name][1] for name in
              ("roof", "disk", "outer")), (found, foam))
    judged(folder / "poly")
    if shutil.which("cgnscheck"):
        said = cgns_complaints(folder / "poly.cgns")
        check("columns over polygons: cgnscheck finds nothing", not said, "\n".join(said[:9]))
    for name in ("poly.su2", "poly"):
        check_exit(f"columns over polygons: check {name}", run("check", folder / name), 0)


USUAL = ("--distance", 0.2, "--layers", LAYERS, "--first-cell", 0.02, "--quiet")


def sheets(folder):
    return ("--internal", f"{folder / 'roof.fmt'}:roof", "--internal",
            f"{folder / 'disk.fmt'}:disk", "--bc", "disk:outflow")


with scratch() as folder:
    folder = Path(folder)
    check_exit("example channel", run("example", "channel", "--points", 9, "-o",
                                      folder / "channel.cgns"), 0)
    sheet(folder / "roof.fmt", (-1, 5), (-1, 2), HIGH)
    sheet(folder / "disk.fmt", (2.1, 3.1), (-1, 2), LOW)
    grids = judge_blocks("blocks", folder)
    whole = points(grids[3])[-1][..., 2]
    check("all columns of the upper block end on the roof", np.abs(whole - HIGH).max() < 1e-12,
          whole)
    judge_topology(folder)
    judge_polygons(folder)
    sheet(folder / "exact.fmt", (0, 4), (0, 0.5), HIGH)
    made = run("mesh", folder / "channel.cgns", "-o", folder / "exact.vtm", *USUAL, "--internal",
               f"{folder / 'exact.fmt'}:roof")
    check_exit("a sheet that ends on the domain's planes: mesh", made, 0)
    whole = points(blocks(folder / "exact.vtm")[3])[-1][..., 2]
    check("all columns of the upper block end on it, those on the planes too",
          np.abs(whole - HIGH).max() < 1e-12, whole)

    def wall_beside(name, *internal):
        made = run("mesh", folder / "channel.cgns", "-o", folder / f"{name}.vtm", *USUAL,
                   "--repair", "off", *internal)
        check_exit(f"{name}: mesh", made, made.returncode if made.returncode in (0, 1) else 0)
        return [points(grid)[0] for grid in blocks(folder / f"{name}.vtm")]

    sheet(folder / "near.fmt", (-1, 5), (-1, 2), 0.999)
    alone = wall_beside("alone")
    beside = wall_beside("beside", "--internal", f"{folder / 'near.fmt'}:near")
    check("points of a wall that a sheet runs along stay where they are",
          all((a == b).all() for a, b in zip(alone, beside, strict=True)))

    # A sheet that stands on a patch between its sides.
    at = alone[3][0, alone[3].shape[1] // 2, 0]
    py, pz = np.meshgrid(np.linspace(-1, 2, 5), np.linspace(0.5, 1.2, 5))
    values = np.concatenate([np.full(py.size, at), py.ravel(), pz.ravel()])
    (folder / "wake.fmt").write_text("1\n5 5 1\n" + "\n".join(map(repr, values.tolist())) + "\n")
    said = run("mesh", folder / "channel.cgns", "-o", folder / "wake.vtm", *USUAL[:-1],
               "--internal", f"{folder / 'wake.fmt'}:wake")
    check("a sheet that stands within a patch is warned of",
          "the surface 'wake' stands on" in said.stderr and "part the patch" in said.stderr,
          said.stderr)

finish()
