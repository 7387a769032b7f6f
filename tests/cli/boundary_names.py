"""The .vtm names every boundary, says VTK."""

from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch
from _vtk import blocks, boundaries, points

with scratch() as folder:
    file = example(folder, "channel", "--points", 9)
    out = Path(folder) / "out.vtm"
    made = run("mesh", file, "--distance", 0.2, "--layers", 6, "--first-cell", 0.02,
               "--plane", "x=0:inlet", "--plane", "x=4:outlet", "-o", out)
    check_exit("a channel", made, 0)
    grids, faces = blocks(out), boundaries(out)
    check("a block for each patch", len(grids) == 4, len(grids))
    walls = {"wall"}  # a PLOT3D file has no families
    check("each boundary has its name",
          set(faces) == walls | {"outer", "inlet", "outlet", "symmetry", "symmetry 2"}, set(faces))
    for name, axis, place in [("inlet", 0, 0), ("outlet", 0, 4), ("symmetry", 1, None),
                              ("symmetry 2", 1, None)]:
        at = [points(grid)[..., axis] for grid in faces.get(name, [])]
        same = at and all((part == at[0].flat[0]).all() for part in at)
        check(f"{name} lies in its plane", same and place in (None, at[0].flat[0]), at)
    for name in ("outer", "wall"):
        found = sum(grid.GetNumberOfCells() for grid in faces.get(name, []))
        meant = sum(grid.GetNumberOfCells() // 6 for grid in grids)
        check(f"{name} has all its faces", found == meant, (found, meant))

finish()
