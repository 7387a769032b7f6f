"""VTK's own quality of our blocks, cell by cell and row by row of the report: positive off smooth
convex walls, and where walls are concave as bad as the report says. And the table of --verbose."""

import json
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch
from _vtk import blocks, cell_data, corners, edge_ratios, measured, np

CONVEX = {"sphere": ("--points", 17), "cube": ("--points", 9)}
CONCAVE = {"torus": ("--points", 17), "l-bar": ("--points", 9), "u-slot": ("--points", 9)}
LAYERS = 20
FLOAT = 2.0 ** -23  # cells' fields are in single precision
ROUNDING = 1e-9     # of thin cells' coordinates


def volumes(cells):
    """Within the faces, each the mean of two triangles by the one diagonal and by the other."""
    p = cells - cells[:, :1]
    faces = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    six_fold = 0
    for face in faces:
        a, b, c, d = (p[:, n] for n in face)
        for one, two, three in ((a, b, c), (a, c, d), (a, b, d), (b, c, d)):
            six_fold = six_fold + 0.5 * np.einsum("ni,ni->n", np.cross(one, two), three)
    return six_fold / 6


def orthogonality(cells):
    """Least cosine between columns and the normal of the face at k = 0."""
    normal = np.cross(cells[:, 2] - cells[:, 0], cells[:, 3] - cells[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    up = cells[:, 4:] - cells[:, :4]
    return np.min(np.einsum("nci,ni->nc", up, normal) / np.linalg.norm(up, axis=2), axis=1)


def growth(cells):
    """Of each layer of cells over the one below, from the second layer on."""
    heights = np.linalg.norm(cells[:, 4:] - cells[:, :4], axis=2).reshape(LAYERS, -1, 4)
    return np.max(heights[1:] / heights[:-1], axis=2)


def near(ours, theirs, tolerance, least=1):
    return bool(np.all(np.abs(ours - theirs) <= tolerance * np.maximum(least, np.abs(theirs))))


def check_fields(name, grids):
    """Cell by cell, the fields that were written against VTK and numpy."""
    for field, judge, tolerance in [
            ("scaled_jacobian", lambda g: measured(g, "ScaledJacobian"), FLOAT),
            ("skewness", lambda g: measured(g, "Skew"), FLOAT),
            ("aspect_ratio", edge_ratios, FLOAT + ROUNDING),
            ("orthogonality", lambda g: orthogonality(corners(g)), FLOAT + ROUNDING)]:
        pairs = [(cell_data(g, field), judge(g)) for g in grids]
        worst = max(float(np.max(np.abs(a - b))) for a, b in pairs)
        check(f"{name}: {field} is VTK's in every cell (to {worst:.1e})",
              all(near(a, b, tolerance) for a, b in pairs), worst)
    for g in grids:
        box = np.prod(np.ptp(corners(g), axis=1), axis=1)
        check(f"{name}: volume is that within its faces, to a part of the cell's box",
              near(cell_data(g, "volume"), volumes(corners(g)), FLOAT + ROUNDING, least=box))
        ours = cell_data(g, "growth").reshape(LAYERS, -1)
        check(f"{name}: growth is that of the heights, 1 at the wall",
              np.all(ours[0] == 1) and near(ours[1:], growth(corners(g)), FLOAT + ROUNDING))


def check_rows(name, grids, quality):
    """The report's levels and patches against VTK's values."""
    jacobian = [measured(g, "ScaledJacobian").reshape(LAYERS, -1) for g in grids]
    skew = [measured(g, "Skew").reshape(LAYERS, -1) for g in grids]
    aspect = [edge_ratios(g).reshape(LAYERS, -1) for g in grids]
    levels, patches = quality["levels"], quality["patches"]
    check(f"{name}: a row for each layer and each patch",
          len(levels) == LAYERS and len(patches) == len(grids)
          and [row["level"] for row in levels] == list(range(1, LAYERS + 1)), quality)
    for what, rows, select in [("levels", levels, lambda part, n: [b[n] for b in part]),
                               ("patches", patches, lambda part, n: [part[n].ravel()])]:
        worst = 0
        for n, row in enumerate(rows):
            check_cells = sum(len(b) for b in select(jacobian, n))
            least = min(b.min() for b in select(jacobian, n))
            most = max(b.max() for b in select(skew, n))
            longest = max(b.max() for b in select(aspect, n))
            worst = max(worst, abs(row["min_scaled_jacobian"] - least),
                        abs(row["max_skewness"] - most),
                        abs(row["max_aspect_ratio"] / longest - 1),
                        abs(row["cells"] - check_cells))
        check(f"{name}: the rows of {what} hold VTK's extremes (to {worst:.1e})", worst < ROUNDING)


with scratch() as name_of_folder:
    folder = Path(name_of_folder)
    for name, options in {**CONVEX, **CONCAVE}.items():
        surface = example(folder, name, *options)
        vtm, report_file = folder / f"{name}.vtm", folder / f"{name}.json"
        done = run("mesh", surface, "--distance", 0.3, "--layers", LAYERS, "--first-cell", 1e-3,
                   "-o", vtm, "--report", report_file)
        quality = json.loads(report_file.read_text())["quality"]
        grids = blocks(vtm)
        theirs = np.concatenate([measured(g, "ScaledJacobian") for g in grids])
        check(f"{name}: VTK's least scaled Jacobian {theirs.min():.4f} is ours",
              abs(theirs.min() - quality["min_scaled_jacobian"]) < 1e-6, quality)
        check(f"{name}: VTK's mean too",
              abs(theirs.mean() - quality["mean_scaled_jacobian"]) < 1e-6, theirs.mean())
        folded = int((theirs <= 0).sum())
        check(f"{name}: we count every cell that VTK calls folded ({folded})",
              quality["nonpositive_cells"] >= folded, quality)
        bad = [sum(row["nonpositive_cells"] for row in quality[rows])
               for rows in ("levels", "patches")]
        check(f"{name}: levels and patches add up to it",
              bad == [quality["nonpositive_cells"]] * 2, bad)
        check_exit(f"{name}: the exit code tells", done, 1 if quality["nonpositive_cells"] else 0)
        check(f"{name}: no table without --verbose", "skewness" not in done.stderr, done.stderr)
        if name in CONVEX:
            check(f"{name}: no cell is folded",
                  theirs.min() > 0 and not quality["nonpositive_cells"])
        check_fields(name, grids)
        check_rows(name, grids, quality)

    # --- the table: a row a layer while there are few, bands of them when there are many
    for layers, expected in [(6, [str(n) for n in range(1, 7)]), (30, ["1"] + [
            f"{n}-{n + 1}" for n in range(2, 30, 2)] + ["30"])]:
        report_file = folder / "table.json"
        told = run("mesh", folder / "sphere.xyz", "--distance", 0.4, "--layers", layers,
                   "--first-cell", 0.01, "-o", folder / "table.xyz", "--report", report_file,
                   "--verbose")
        quality = json.loads(report_file.read_text())["quality"]
        lines = told.stderr.splitlines()
        heads = [n for n, line in enumerate(lines) if "skewness" in line]
        check(f"{layers} layers: the table has levels, patches and all", len(heads) == 3,
              told.stderr)
        rows = [line.split() for line in lines[heads[0] + 1:heads[1]] if "report" not in line]
        check(f"{layers} layers: its rows", [row[0] for row in rows] == expected, told.stderr)
        check("they count every cell",
              sum(int(row[1]) for row in rows) == quality["patches"][0]["cells"] * 6, rows)
        for row in rows:
            first, last = int(row[0].split("-")[0]), int(row[0].split("-")[-1])
            band = quality["levels"][first - 1:last]
            off = np.degrees(np.arccos(min(level["min_orthogonality"] for level in band)))
            check(f"levels {row[0]}: the worst of them, the angle in degrees",
                  row[3] == f"{min(level['min_scaled_jacobian'] for level in band):.4f}"
                  and row[5] == f"{max(level['max_skewness'] for level in band):.4f}"
                  and abs(float(row[7].rstrip("\u00b0")) - off) < 0.006, (row, off))
        check("the table names every patch", all(
            any(line.strip().startswith(p["patch"]) for line in lines) for p in quality["patches"]))
finish()
