"""Surfaces that others made, meshed as their users would; outside programs read the result."""

import json
import shutil
import subprocess
from pathlib import Path

from _command import DATA, check, check_exit, finish, run, scratch, skip
from _vtk import blocks, distances, np, point_data, points, wall

if not (DATA / "plot3d").is_dir():
    skip("the real geometry is not here")

CASES = {
    "bwb": (2, 1e-4, dict(patches=9, points=14105, nodes=13457, faces=13376, cells=642048)),
    "m6_small": (0.1, 1e-5, dict(patches=9, points=16001, nodes=15321, faces=15232, cells=731136)),
    "uneven_sphere": (0.5, 1e-4, dict(patches=6, points=1734, nodes=1538, faces=1536, cells=73728)),
}


def judge(name, distance, first, counts, folder):
    out = {kind: folder / f"{name}.{kind}" for kind in ("vtm", "vdb", "json")}
    done = run("mesh", DATA / "plot3d" / f"{name}.fmt", "--distance", distance, "--layers", 48,
               "--first-cell", first, "-o", out["vtm"], "--vdb", out["vdb"],
               "--report", out["json"])
    report = json.loads(out["json"].read_text())
    bad = report["quality"]["nonpositive_cells"]
    check_exit(f"{name}: {bad} non-positive cells", done, 1 if bad else 0)
    surface, march = report["surface"], report["march"]
    for key in ("patches", "points", "nodes", "faces"):
        check(f"{name}: {counts[key]} {key}", surface[key] == counts[key], surface)
    check(f"{name}: {counts['cells']} cells in as many blocks as patches",
          report["blocks"]["cells"] == counts["cells"]
          and report["blocks"]["count"] == counts["patches"], report["blocks"])
    ended = march["reached"] + march["collided"] + march["left_band"]
    check(f"{name}: every column ends in one way, 99 % at the distance",
          ended == march["nodes"] == counts["nodes"] and march["reached"] > 0.99 * ended, march)

    grids = blocks(out["vtm"])
    stop = np.concatenate([point_data(g, "stop")[-1].ravel() for g in grids])
    node = np.concatenate([point_data(g, "node")[-1].ravel() for g in grids])
    check(f"{name}: the files mark the columns that did not reach it",
          len(set(node[(stop != 0) & (stop != 5)])) == ended - march["reached"])
    check(f"{name}: and those that the repair moved, no more than its report says",
          len(set(node[stop == 5])) <= report["repair"]["columns"], report["repair"])
    ends = np.concatenate([points(g)[-1].reshape(-1, 3) for g in grids])[stop == 0]
    # The report's figure is over all nodes; VTK takes a millisecond a point, so it looks at some.
    sample = ends[:: max(1, len(ends) // 1000)]
    error = np.abs(distances(wall(grids), sample) / distance - 1).max()
    check(f"{name}: VTK finds the outer level at the distance, to {error:.1e}", error < 1e-6)
    check(f"{name}: all end points are at it, says the report", march["distance_error_max"] < 1e-6)
    if shutil.which("vdb_print"):
        listed = subprocess.run(["vdb_print", "-l", out["vdb"]], capture_output=True, text=True)
        check(f"{name}: vdb_print lists phi and level", listed.returncode == 0
              and "Name: phi" in listed.stdout and "Name: level" in listed.stdout, listed.stderr)
    else:
        print("skipped: vdb_print is not installed")


with scratch() as folder:
    for name, (distance, first, counts) in CASES.items():
        judge(name, distance, first, counts, Path(folder))
    for file in sorted((DATA / "plot3d").iterdir()):
        looked = run("info", file)
        check(f"{file.name}: info reads it", looked.returncode == 0, looked.stderr)
        tried = run("mesh", file, "--distance", 0.01, "--layers", 4, "--dry-run")
        check(f"{file.name}: planned, or refused with a reason", tried.returncode == 0
              or (tried.returncode in (2, 3) and file.name in tried.stderr), tried.stderr)
finish()
