"""Two dimensions: what is said of the ends of curves, and plane grids that solvers take."""

import json
import math
from pathlib import Path

from _command import check, check_exit, finish, run, scratch


def write(file, curves):
    text = [str(len(curves))] + [f"{len(curve)} 1 1" for curve in curves]
    for curve in curves:
        text += [repr(float(p[axis])) for axis in range(2) for p in curve] + ["0.0"] * len(curve)
    file.write_text("\n".join(text) + "\n")
    return file


def arc(start, end, count=25):
    angles = [math.radians(start + (end - start) * n / (count - 1)) for n in range(count)]
    tidy = lambda x: 0.0 if abs(x) < 1e-15 else x
    return [(tidy(math.cos(a)), tidy(math.sin(a))) for a in angles]


def foil(thick):
    curve = []
    for n in range(-30, 31):
        x = (n / 30)**2
        y = 0.3 * math.sqrt(x) * (1 - x) + 0.5 * thick * x
        curve.append((x, y if n < 0 else -y))
    return curve


def areas(file):
    """Of the first block of a plane PLOT3D text, cell by cell: above 0 where it is right-handed."""
    words = file.read_text().split()
    count = int(words[0])
    ni, nj = int(words[1]), int(words[2])
    at = 1 + 2 * count
    x = [float(w) for w in words[at:at + ni * nj]]
    y = [float(w) for w in words[at + ni * nj:at + 2 * ni * nj]]
    p = lambda i, j: (x[j * ni + i], y[j * ni + i])
    out = []
    for j in range(nj - 1):
        for i in range(ni - 1):
            a, b, c, d = p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)
            out.append((c[0] - a[0]) * (d[1] - b[1]) - (c[1] - a[1]) * (d[0] - b[0]))
    return out


with scratch() as folder:
    folder = Path(folder)
    half = write(folder / "half.fmt", [arc(0, 180)])
    tail = write(folder / "tail.fmt", [foil(0.0025)])

    def mesh(surface, *options):
        return run("mesh", surface, "--distance", 0.1, "--layers", 4, "--first-cell", 0.01, "-o",
                   folder / "out.fmt", "--report", folder / "report.json", *options)

    made = mesh(half)
    check_exit("half a circle", made, 0, "1 curve, 25 points, 24 cells, in two dimensions",
               "'symmetry' (line y = 0, 2 ends)", "25 nodes: 25 reached")
    report = json.loads((folder / "report.json").read_text())
    check("nodes are counted once", report["surface"]["nodes"] == report["march"]["nodes"] == 25
          and report["surface"]["points"] == 25 and report["surface"]["free_edges"] == 2, report)
    check("a plane grid is right-handed", min(areas(folder / "out.fmt")) > 0)
    check_exit("the other side", mesh(half, "--side", "against"), 0)
    check("is right-handed too", min(areas(folder / "out.fmt")) > 0)
    check_exit("a named line", mesh(half, "--plane", "0,0/0,2:wake"), 0, "'wake' (line y = 0")
    check_exit("the plane itself", mesh(half, "--plane", "z=0:side"), 2, "z = 0",
               "in two dimensions", "lines")
    check_exit("an oblique line", mesh(write(folder / "turned.fmt", [arc(30, 210)])), 0,
               "(line through (")
    made = mesh(tail)
    check_exit("an open trailing edge", made, 0, "ends of curves on no boundary", "0.0025 apart",
               "first point to close it")
    check("has no line of symmetry", "symmetry" not in made.stderr, made.stderr)
    made = mesh(tail, "--open-edges", "refuse")
    check_exit("refused", made, 2, "its first point, at (1, 0.00125)",
               "its last point, at (1, -0.00125)", "close the trailing edge")
    check("without a word of sides or z",
          not any(word in made.stderr for word in ("side ", "imin", "z =")), made.stderr)
    check_exit("closed", mesh(write(folder / "closed.fmt", [foil(0.0025) + foil(0.0025)[:1]]),
                              "--open-edges", "refuse"), 0)

finish()
