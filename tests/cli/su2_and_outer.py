"""SU2 meshes and outermost levels, read by parsers of their own, against the .vtm of the run."""

import shutil
import struct
import subprocess
from collections import Counter
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch
from _vtk import blocks, boundaries, np, points

CORNERS = {3: 2, 5: 3, 9: 4, 10: 4, 12: 8, 13: 6, 14: 5}


def read_su2(file):
    """Dimension, elements, points, markers."""
    lines = iter(Path(file).read_text().splitlines())

    def after(key, without=None):
        name, value = next(lines, without).split("=")
        assert name == key, (name, key)
        return value.strip()

    def elements(count):
        """Type and points; gmsh puts a number behind them."""
        rows = [list(map(int, next(lines).split())) for _ in range(count)]
        assert all(len(row) - 1 - CORNERS[row[0]] in (0, 1) for row in rows)
        return [row[:1 + CORNERS[row[0]]] for row in rows]

    dimension = int(after("NDIME"))
    cells = elements(int(after("NELEM")))
    places = np.array([list(map(float, next(lines).split())) for _ in range(int(after("NPOIN")))])
    assert places.shape[1] - dimension in (0, 1)
    places = places[:, :dimension]
    markers = {}
    for _ in range(int(after("NMARK", "NMARK=0"))):
        name = after("MARKER_TAG")
        markers[name] = elements(int(after("MARKER_ELEMS")))
    assert next(lines, None) is None
    return dimension, cells, places, markers


def sides(cell):
    """The faces of a cell (in two dimensions: its edges), by their points; outward."""
    kind, *p = cell
    ring = {5: [(0, 1), (1, 2), (2, 0)], 9: [(0, 1), (1, 2), (2, 3), (3, 0)],
            10: [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
            12: [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                 (3, 0, 4, 7)],
            13: [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
            14: [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]}[kind]
    found = [[p[n] for n in face] for face in ring]
    least = 2 if kind in (5, 9) else 3
    return [face for face in found if len(set(face)) >= least]


def volume(cell, places):
    """By the divergence theorem, faces as triangles about their mean; positive if right-handed."""
    if places.shape[1] == 2:
        x, y = places[cell[1:]].T
        return 0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    total, origin = 0.0, places[cell[1]]
    for face in sides(cell):
        ring = places[face] - origin
        total += np.einsum("ij,ij->i", np.cross(ring, np.roll(ring, -1, 0)),
                           np.tile(ring.mean(0), (len(ring), 1))).sum() / 6
    return total


def rows(array):
    return {tuple(row) for row in array.tolist()}


def least_corner(cell, places):
    """The least triple product of three edges at a corner of the base, over their lengths: of a
    tetrahedron or pyramid, whose map is positive if these are."""
    *base, apex = places[cell[1:]]
    count = len(base)
    edges = [(base[(n + 1) % count] - p, base[n - 1] - p, apex - p) for n, p in enumerate(base)]
    return min(np.dot(np.cross(a, b), c) / np.prod(np.linalg.norm((a, b, c), axis=1))
               for a, b, c in edges)


def judge_faces(name, cells, markers):
    faces = Counter(tuple(sorted(set(face))) for cell in cells for face in sides(cell))
    outside = Counter(tuple(sorted(set(e[1:]))) for part in markers.values() for e in part)
    check(f"{name}: markers are the faces of one cell, each once; all others are of two",
          outside == Counter(f for f, n in faces.items() if n == 1)
          and max(faces.values()) == 2 and set(outside.values()) == {1}, Counter(faces.values()))


def judge_parted(name, file, grids):
    """Fans that close on a node: cells that are no element become some, and are valid."""
    _, cells, places, markers = read_su2(file)
    meant = np.concatenate([points(grid).reshape(-1, 3) for grid in grids])
    further = rows(places) - rows(meant)
    check(f"{name}: points are the blocks', bit for bit, and the middles of parted cells",
          rows(meant) <= rows(places) and len(further) > 0
          and len(cells) > sum(grid.GetNumberOfCells() for grid in grids), len(further))
    check(f"{name}: every cell is positive", min(volume(c, places) for c in cells) > 0)
    parts = [cell for cell in cells if cell[0] in (10, 14)]
    check(f"{name}: so is every corner of tetrahedra and pyramids",
          min(least_corner(cell, places) for cell in parts) > 1e-6,
          sorted(least_corner(cell, places) for cell in parts)[:5])
    judge_faces(name, cells, markers)


def judge_su2(name, file, grids, groups):
    dimension, cells, places, markers = read_su2(file)
    grid_points = [points(grid) for grid in grids]
    meant = np.concatenate([p.reshape(-1, 3) for p in grid_points])
    if dimension == 2:
        meant = meant[meant[:, 2] == meant[:, 2].min()][:, :2]
    check(f"{name}: points are the blocks', each once, bit for bit",
          rows(places) == rows(meant) and len(rows(places)) == len(places),
          (len(places), len(rows(places)), len(rows(meant))))
    check(f"{name}: as many cells as the blocks have",
          len(cells) == sum(grid.GetNumberOfCells() for grid in grids), len(cells))
    check(f"{name}: every point is used",
          len({p for cell in cells for p in cell[1:]}) == len(places))
    check(f"{name}: every cell is positive", min(volume(c, places) for c in cells) > 0)
    judge_faces(name, cells, markers)
    flat = dimension == 2
    meant = {key.replace(" ", "_"): sum(g.GetNumberOfCells() for g in group)
             for key, group in groups.items()
             if not (flat and key in ("front", "back")) and key not in ("pole", "edge", "corner")}
    check(f"{name}: markers are the boundaries of the .vtm",
          {key: len(part) for key, part in markers.items()} == meant, (meant, markers.keys()))
    return Counter(cell[0] for cell in cells)


def read_obj(file):
    lines = [line.split() for line in Path(file).read_text().splitlines()]
    places = np.array([list(map(float, line[1:])) for line in lines if line[0] == "v"])
    return places, [[int(p) - 1 for p in line[1:]] for line in lines if line[0] in "fl"]


def read_stl(file):
    data = Path(file).read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    assert len(data) == 84 + 50 * count
    values = np.frombuffer(data, dtype=np.dtype([("v", "<f4", 12), ("a", "<u2")]), offset=84)
    return values["v"][:, 3:].reshape(-1, 3, 3)


def edges(faces):
    return Counter((a, b) for f in faces for a, b in zip(f, f[1:] + f[:1]))


def is_watertight(faces):
    """Every edge is used once each way."""
    found = edges(faces)
    return all(n == 1 and found[b, a] == 1 for (a, b), n in found.items())


def enclosed(triangles):
    a, b, c = (triangles[:, n].astype(float) for n in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def judge_outer(name, folder, grids, closed=True):
    level = np.concatenate([points(grid)[-1].reshape(-1, 3) for grid in grids])
    places, faces = read_obj(folder / "outer.obj")
    check(f"{name}: .obj has the blocks' outermost points, each once, bit for bit",
          rows(places) == rows(level) and len(rows(places)) == len(places))
    numbers = {}
    stl = read_stl(folder / "outer.stl")
    corners = [[numbers.setdefault(tuple(p), len(numbers)) for p in t] for t in stl.tolist()]
    check(f"{name}: .stl has them rounded to floats",
          set(numbers) == rows(level.astype(np.float32)))
    raw = np.fromfile(folder / "outer.xyz", dtype=np.int32)
    count = raw[1]
    sizes = raw[4:4 + 3 * count].reshape(-1, 3)
    data, at = (folder / "outer.xyz").read_bytes(), 12 + 8 + 12 * count
    same = []
    for (ni, nj, nk), grid in zip(sizes, grids):
        block = np.frombuffer(data, np.float64, 3 * ni * nj, at + 4).reshape(3, nj, ni)
        same.append(nk == 1 and (np.moveaxis(block, 0, -1) == points(grid)[-1]).all())
        at += 8 + 24 * ni * nj
    check(f"{name}: PLOT3D has the blocks' outermost points, bit for bit",
          len(sizes) == len(grids) and at == len(data) and all(same))
    if closed:
        check(f"{name}: .obj and .stl are watertight", is_watertight(faces)
              and is_watertight(corners), (len(faces), len(corners)))
        inner = np.concatenate([points(grid)[0].reshape(-1, 3) for grid in grids])
        check(f"{name}: they are oriented outward",
              enclosed(stl) > np.prod(np.ptp(inner, axis=0)) / 10, enclosed(stl))


def meshed(folder, surface, *options, kinds=("obj", "stl", "xyz")):
    outer = [part for kind in kinds for part in ("--outer-surface", folder / f"outer.{kind}")]
    made = run("mesh", surface, "--distance", 0.05, "--layers", 3, "-o", folder / "out.su2",
               "-o", folder / "out.vtm", *outer, *options)
    check_exit(f"mesh {Path(surface).stem} {' '.join(map(str, options))}", made, 0)
    return blocks(folder / "out.vtm"), boundaries(folder / "out.vtm")


with scratch() as folder:
    folder = Path(folder)
    for name, options in (("cube", ()), ("cube", ("--fans", 2)), ("sphere", ()), ("wedge", ()),
                          ("quarter-cylinder", ()), ("naca0012-wing", ())):
        title = " ".join(map(str, (name, *options)))
        size = () if name == "naca0012-wing" else ("--points", 9)
        grids, groups = meshed(folder, example(folder, name, *size), *options)
        kinds = judge_su2(title, folder / "out.su2", grids, groups)
        if "--fans" in options:
            # Twelve edges of eight cells, two columns each, on collapsed edges; eight corners
            # of three cells each.
            check("fans: prisms on edges, pyramids on corners",
                  (kinds[13], kinds[14]) == (12 * 8 * 2, 8 * 3), kinds)
        judge_outer(title, folder, grids, closed=name not in ("quarter-cylinder", "naca0012-wing"))

    for tips, size in ((5, 9), (5, 17), (7, 9)):
        star = example(folder, "star", "--points", size, "--tips", tips)
        grids, _ = meshed(folder, star, "--fans", 2, kinds=())
        judge_parted(f"star of {tips} tips, fans", folder / "out.su2", grids)

    # A sphere of one patch: poles and a seam.
    n = np.linspace(0, np.pi, 9), np.linspace(0, 2 * np.pi, 17)
    polar, around = np.meshgrid(*n, indexing="xy")
    ball = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around),
                     np.cos(polar)])
    ball[:, :, 0], ball[:, :, -1] = [[0], [0], [1]], [[0], [0], [-1]]
    ball[:, -1] = ball[:, 0]
    pole = folder / "pole.fmt"
    pole.write_text("1\n9 17 1\n" + "\n".join(repr(float(v)) for v in ball.ravel()))
    grids, groups = meshed(folder, pole)
    kinds = judge_su2("one patch with poles", folder / "out.su2", grids, groups)
    check("poles: prisms", kinds == {12: 6 * 16 * 3, 13: 2 * 16 * 3}, kinds)
    judge_outer("one patch with poles", folder, grids)

    for name in ("airfoil", "circle"):
        grids, groups = meshed(folder, example(folder, name), kinds=("obj",))
        kinds = judge_su2(name, folder / "out.su2", grids, groups)
        check(f"{name}: quadrilaterals", set(kinds) == {9}, kinds)
        places, lines = read_obj(folder / "outer.obj")
        check(f"{name}: the outermost curve is closed",
              set(Counter(p for line in lines for p in line).values()) == {2})
    said = run("mesh", folder / "circle.xyz", "--distance", 0.1, "-o", folder / "a.su2",
               "--outer-surface", folder / "a.stl")
    check_exit("a curve as STL", said, 2, "STL", ".obj")
    said = run("mesh", folder / "cube.xyz", "--distance", 0.1, "--outer-surface", folder / "a.vtm",
               "-o", folder / "a.su2")
    check_exit("an extension that is no surface", said, 2, ".vtm", ".stl")

    gmsh = shutil.which("gmsh")
    if gmsh is None:
        print("no gmsh: filling is left out")
        finish()
    tube = folder / "tube.xyz"
    check_exit("example draft-tube --closed",
               run("example", "draft-tube", "--closed", "-o", tube, "--points", 7), 0)
    check_exit("mesh draft-tube", run("mesh", tube, "--distance", 0.1, "--layers", 3,
                                      "-o", folder / "tube.su2", "--outer-surface",
                                      folder / "tube.stl"), 0)
    job = folder / "tube.geo"
    job.write_text('Merge "tube.stl";\nSurface Loop(1) = {1};\nVolume(1) = {1};\n')
    made = subprocess.run([gmsh, "-3", "-format", "su2", "-o", "core.su2", "tube.geo"], cwd=folder,
                          capture_output=True, text=True)
    said = made.stdout + made.stderr
    check("gmsh fills the closed draft tube", made.returncode == 0, said[-1500:])
    _, cells, places, _ = read_su2(folder / "core.su2")
    check("with tetrahedra alone", {cell[0] for cell in cells} == {10})
    core, whole = sum(volume(cell, places) for cell in cells), abs(enclosed(read_stl(
        folder / "tube.stl")))
    check("which fill its volume, to the rounding of the STL", abs(core / whole - 1) < 1e-6,
          (core, whole))

finish()
