"""VTK's own scaled Jacobian on our blocks: positive off smooth convex walls, and where walls are
concave as small as the report says."""

import json
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch
from _vtk import blocks, np, scaled_jacobians

CONVEX = {"sphere": ("--points", 17), "cube": ("--points", 9)}
CONCAVE = {"torus": ("--points", 17), "l-bar": ("--points", 9), "u-slot": ("--points", 9)}

with scratch() as name_of_folder:
    folder = Path(name_of_folder)
    for name, options in {**CONVEX, **CONCAVE}.items():
        surface = example(folder, name, *options)
        vtm, report_file = folder / f"{name}.vtm", folder / f"{name}.json"
        done = run("mesh", surface, "--distance", 0.3, "--layers", 20, "--first-cell", 1e-3,
                   "-o", vtm, "--report", report_file)
        quality = json.loads(report_file.read_text())["quality"]
        theirs = np.concatenate([scaled_jacobians(g) for g in blocks(vtm)])
        check(f"{name}: VTK's least scaled Jacobian {theirs.min():.4f} is ours",
              abs(theirs.min() - quality["min_scaled_jacobian"]) < 1e-6, quality)
        check(f"{name}: VTK's mean too",
              abs(theirs.mean() - quality["mean_scaled_jacobian"]) < 1e-6, theirs.mean())
        folded = int((theirs <= 0).sum())
        check(f"{name}: we count every cell that VTK calls folded ({folded})",
              quality["nonpositive_cells"] >= folded, quality)
        check_exit(f"{name}: the exit code tells", done, 1 if quality["nonpositive_cells"] else 0)
        if name in CONVEX:
            check(f"{name}: no cell is folded",
                  theirs.min() > 0 and not quality["nonpositive_cells"])
finish()
