"""The .vtm's height is each point's own distance to the wall, says VTK."""

from pathlib import Path

from _command import check, example, finish, run, scratch
from _vtk import blocks, distances, np, point_data, points, wall

with scratch() as folder:
    # Two columns, in the middle, collide half-way and are squeezed there.
    file = example(folder, "sphere-pair", "--points", 17, "--gap", 0.2)
    out = Path(folder) / "out.vtm"
    made = run("mesh", file, "--distance", 0.5, "--layers", 6, "--first-cell", 0.02, "-o", out)
    # Cells between the bodies may fold, which is not looked at here.
    check("two spheres", made.returncode in (0, 1), made)
    grids = blocks(out)
    walls = wall(grids)
    stop = np.concatenate([point_data(g, "stop").reshape(7, -1) for g in grids], 1)
    height = np.concatenate([point_data(g, "height").reshape(7, -1) for g in grids], 1)
    place = np.concatenate([points(g).reshape(7, -1, 3) for g in grids], 1)
    for kind, columns in [("full", stop[0] == 0), ("short", stop[0] == 1)]:
        check(f"there are {kind} columns", columns.any(), columns.sum())
        # VTK takes a millisecond a point.
        step = max(1, columns.sum() // 200)
        at, said = place[:, columns][:, ::step], height[:, columns][:, ::step]
        true = distances(walls, at.reshape(-1, 3)).reshape(said.shape)
        worst = np.abs(true - said).max(axis=1) / 0.5
        check(f"{kind}: height is the true distance at every level", worst.max() < 1e-5, worst)

finish()
