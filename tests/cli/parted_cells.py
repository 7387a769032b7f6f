"""Cells with a column of no height (no direction leaves a corner of cubes), as SU2 has them."""

import itertools
import re
from pathlib import Path

from _command import check, check_exit, finish, run, scratch

CUBES = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 1, 0), (2, 0, 0)]


def write_cubes(file):
    """Each unit cube of eight: the quads between those that are and those that are not, outward."""
    solid = {tuple(2 * c + d for c, d in zip(cube, step))
             for cube in CUBES for step in itertools.product((0, 1), repeat=3)}
    numbers, faces = {}, []
    for cell in sorted(solid):
        for axis, side in itertools.product(range(3), (0, 1)):
            beyond = tuple(c + (2 * side - 1) * (n == axis) for n, c in enumerate(cell))
            if beyond in solid:
                continue
            ring = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))[::1 if side else -1]:
                step = [0, 0, 0]
                step[axis], step[(axis + 1) % 3], step[(axis + 2) % 3] = side, u, v
                place = tuple((c + s) / 2 for c, s in zip(cell, step))
                ring.append(numbers.setdefault(place, len(numbers)))
            faces.append(ring)
    rows = [" ".join(map(str, p)) for p in numbers] + [
        "4 " + " ".join(map(str, face)) for face in faces]
    Path(file).write_text(f"OFF\n{len(numbers)} {len(faces)} 0\n" + "\n".join(rows) + "\n")


with scratch() as folder:
    folder = Path(folder)
    write_cubes(folder / "saddle.off")
    made = run("mesh", folder / "saddle.off", "--distance", 0.2, "--layers", 8, "-o",
               folder / "s.su2", "-o", folder / "s.vtu")
    check_exit("a saddle of cubes, as SU2", made, 0)
    for name in ("s.su2", "s.vtu"):
        judged = run("check", folder / name)
        check_exit(f"check {name}: every cell is positive, and faces fit", judged, 0)
    judged = run("check", folder / "s.su2").stdout
    check("some are pyramids", re.search(r"pyramids +[1-9]", judged) is not None, judged)

finish()
