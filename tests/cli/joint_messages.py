"""What is said where parts of a surface join as no wall does, and where another --weld helps."""

import re
from pathlib import Path

from _command import check, check_exit, finish, run, scratch


def write_obj(file, points, faces):
    lines = ["v {} {} {}".format(*p) for p in points]
    lines += ["f " + " ".join(map(str, f)) for f in faces]
    file.write_text("\n".join(lines) + "\n")


def write_grids(file, grids):
    """Grids of (ni, nj, point of i and j), as PLOT3D."""
    lines = [str(len(grids))] + [f"{ni} {nj} 1" for ni, nj, _ in grids]
    for ni, nj, point in grids:
        points = [point(i, j) for j in range(nj) for i in range(ni)]
        lines += [" ".join(repr(float(p[axis])) for p in points) for axis in range(3)]
    file.write_text("\n".join(lines) + "\n")


def thin_box(n, thickness):
    """All six sides, n cells each way, one cell thick."""
    h = 1 / n

    def face(origin, a, b, na, nb):
        return (na + 1, nb + 1, lambda i, j: [o + i * u + j * v for o, u, v in zip(origin, a, b)])

    x, y, z = (h, 0, 0), (0, h, 0), (0, 0, thickness)
    return [face((0, 0, thickness), x, y, n, n), face((0, 0, 0), y, x, n, n),
            face((0, 0, 0), x, z, n, 1), face((0, 1, 0), z, x, 1, n),
            face((0, 0, 0), z, y, 1, n), face((1, 0, 0), y, z, n, 1)]


with scratch() as folder:
    folder = Path(folder)

    def mesh(*arguments):
        return run("mesh", *arguments, "--distance", 0.2, "--layers", 2, "-o", "a.vtu", cwd=folder)

    # Polygons: the long edge of one quad along the short ones of two.
    write_obj(folder / "tee.obj",
              [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (1, 1, 0), (0, 2, 0), (1, 2, 0),
               (2, 2, 0)],
              [(1, 2, 3, 4), (4, 5, 7, 6), (5, 3, 8, 7)])
    said = mesh("tee.obj")
    check_exit("a T-junction of whole faces", said, 2, "tee.obj", "T-junctions", "(0, 1, 0)",
               "(2, 1, 0)", "split")
    check("is no touch in a point", "in a point alone" not in said.stderr, said.stderr)
    # A quad that stands on the diagonal of another.
    write_obj(folder / "across.obj",
              [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 1), (2, 2, 1)],
              [(1, 2, 3, 4), (1, 3, 6, 5)])
    said = mesh("across.obj")
    check_exit("a face that stands across another", said, 2, "three faces",
               "(0, 0, 0) to (2, 2, 0)", "stands on another", "thickness")
    check("is no touch in a point either", "in a point alone" not in said.stderr, said.stderr)
    write_obj(folder / "on.obj",
              [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0), (1, 0, 1),
               (1, 1, 1)],
              [(1, 2, 3, 4), (2, 5, 6, 3), (2, 3, 8, 7)])
    check_exit("a face that stands on an edge", mesh("on.obj"), 2, "1 edge of more than two faces",
               "of 3 from (1, 0, 0) to (1, 1, 0)", "stands on another")
    write_obj(folder / "point.obj",
              [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 1, 1), (2, 2, 1), (1, 2, 1)],
              [(1, 2, 3, 4), (3, 5, 6, 7)])
    check_exit("faces that do touch in a point", mesh("point.obj"), 2, "in a point alone",
               "(1, 1, 0)")

    # The same of structured patches.
    floor = (5, 5, lambda i, j: (i / 4, j / 4, 0))
    write_grids(folder / "across.fmt", [floor, (3, 3, lambda i, j: (i / 2, i / 2, j / 2))])
    said = mesh("across.fmt")
    check_exit("a patch that stands across another", said, 2, "three faces", "across.fmt",
               "patch 1", "side jmin of patch 2", "stands on another")
    write_grids(folder / "on.fmt", [floor, (5, 3, lambda i, j: (i / 4, 0.5, j / 4))])
    check_exit("a patch that stands on a grid line", mesh("on.fmt"), 2, "3 cells meet on one edge",
               "patch 1", "patch 2", "stands on another")

    # A seam that is open by a twentieth of an edge.
    gap = 0.05 / 4
    seam = [floor, (5, 5, lambda i, j: (1 + gap + i / 4, j / 4, 0.3 * i / 4))]
    for name in ("seam.fmt", "seam.obj"):
        if name.endswith("fmt"):
            write_grids(folder / name, seam)
        else:
            points = [point(i, j) for ni, nj, point in seam for j in range(nj) for i in range(ni)]
            write_obj(folder / name, points,
                      [[1 + 25 * p + 5 * j + i + d for d in (0, 1, 6, 5)]
                       for p in range(2) for j in range(4) for i in range(4)])
        said = mesh(name)
        found = re.search(r"--weld ([0-9.]+) joins", said.stderr)
        check(f"{name}: an open seam is named, with the tolerance that closes it",
              said.returncode == 0 and found and "8, the nearest" in said.stderr, said.stderr)
        if found:
            again = mesh(name, "--weld", found.group(1))
            check(f"{name}: and that closes it", again.returncode == 0
                  and "--weld" not in again.stderr and "open (24 free edges)" in again.stderr,
                  again.stderr)
            less = mesh(name, "--weld", 0.9 * float(found.group(1)))
            check(f"{name}: a little less does not", "--weld" in less.stderr, less.stderr)
    check("info names it", "--weld" in run("info", "seam.fmt", cwd=folder).stdout)

    # Sides nearer to each other than a tolerance that is too large.
    write_grids(folder / "thin.fmt", thin_box(4, 0.05))
    check_exit("a thin box", mesh("thin.fmt"), 0)
    points, faces = [], []
    for ni, nj, point in thin_box(4, 0.05):
        first = 1 + len(points)
        points += [point(i, j) for j in range(nj) for i in range(ni)]
        faces += [[first + ni * j + i + d for d in (0, 1, ni + 1, ni)]
                  for j in range(nj - 1) for i in range(ni - 1)]
    write_obj(folder / "thin.obj", points, faces)
    for name in ("thin.fmt", "thin.obj"):
        said = mesh(name, "--weld", 0.3)
        check_exit(f"{name}: two sides that are near are kept", said, 0)
        check(f"{name}: and are a closed box", "48 faces, closed" in said.stderr, said.stderr)

    # With one side inward they go the same way, as a sheet does that is there twice.
    write_obj(folder / "turned.obj", points, [face[::-1] for face in faces[:16]] + faces[16:])
    said = mesh("turned.obj", "--weld", 0.3)
    found = re.search(r"or take --weld ([0-9.]+)", said.stderr)
    check("turned.obj: sides welded to each other, and what keeps them apart",
          said.returncode == 2 and found and float(found.group(1)) < 0.2, said.stderr)
    if found:
        check_exit("turned.obj: which does", mesh("turned.obj", "--weld", found.group(1)), 0)

finish()
