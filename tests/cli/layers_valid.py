"""No cell of the layers is folded, on small surfaces with sharp inner edges and narrow gaps: by the
report, and by VTK. The whole matrix is tests/bench/layers_matrix.py."""

import sys
from pathlib import Path

from _command import check, finish, scratch

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))
from _vtk import corner_jacobians, np, scaled_jacobians, vtk  # noqa: E402
from layers_matrix import Bench, Run, CASES, one  # noqa: E402

HARD = ["cube", "l-bar 0.5", "u-slot", "wedge 120", "wedge 90", "star", "torus",
        "sphere-pair 0.05", "wing-on-cylinder", "channel", "draft-tube 0.06"]
# Where an inner edge ends, one corner of the wall's cells has sqrt(1/11) = 0.3015.
LEAST = {"cube": 0.577, "l-bar 0.5": 0.3, "u-slot": 0.3, "wedge 90": 0.3, "draft-tube 0.06": 0.25}


def judges_see_folds():
    """One cell, whole and with a corner pushed through the opposite face."""
    for name, z, folded in (("a cube", 1.0, False), ("a cube with a corner pushed in", -0.5, True)):
        corners = [(x, y, up) for up in (0, 1) for y in (0, 1) for x in (0, 1)]
        corners[7] = (1, 1, z)
        grid = vtk.vtkStructuredGrid()
        grid.SetDimensions(2, 2, 2)
        nodes = vtk.vtkPoints()
        nodes.SetDataTypeToDouble()
        for corner in corners:
            nodes.InsertNextPoint(corner)
        grid.SetPoints(nodes)
        check(f"VTK finds {name} {'folded' if folded else 'whole'}",
              (scaled_jacobians(grid)[0] <= 0) == folded, scaled_jacobians(grid))
        check("and so do its corners' determinants",
              (corner_jacobians(grid)[0] <= 0) == folded, corner_jacobians(grid))


judges_see_folds()
with scratch() as folder:
    bench = Bench(folder, timeout=300, threads=1)
    for case, points in [(case, 9) for case in CASES if case.name in HARD] + [
            (case, 17) for case in CASES if case.name == "wedge 90"]:
        row = one(bench, Run(case, points, "default"))
        if case.name in LEAST:
            check(f"{case.name}: cells are as good as the wall's own angles let them be",
                  row.get("vtk_sj", -1) >= LEAST[case.name], row)
        check(f"{case.name}: {row.get('cells')} cells positive, by the report and by VTK",
              not row["failed"], row)
        if "first" in row:
            check(f"{case.name}: the first cell is the one asked for, half of it at the least",
                  row["first"][0] > 0.5 and np.isclose(row["first"][1], 1, rtol=0.01),
                  row["first"])
finish()
