"""A run on a sphere: files, report, silence, threads; and the exits 1 and 4."""

import json
from pathlib import Path

from _command import check, check_exit, example, finish, listing, run, scratch

KEYS = {
    "surface": ["patches", "nodes", "faces", "closed", "free_edges", "families", "flipped"],
    "field": ["voxel_size", "voxel_rule", "active_voxels", "bytes", "sweeps", "converged",
              "last_change_voxels"],
    "march": ["nodes", "reached", "collided", "left_band", "distance_error_max"],
    "blocks": ["count", "cells", "nodes", "interfaces", "boundary_faces"],
    "quality": ["min_scaled_jacobian", "mean_scaled_jacobian", "nonpositive_cells", "min_volume",
                "first_cell", "growth"],
    "time": ["surface", "rasterize", "sweep", "march", "blocks", "io", "total"],
    "run": ["threads", "peak_memory_bytes", "version"],
}

with scratch() as folder:
    folder = Path(folder)
    sphere = example(folder, "sphere", "--points", 9)

    done = run("mesh", "sphere.xyz", "--distance", 0.4, "--layers", 6, "--first-cell", 0.01,
               "-o", "out.xyz", "-o", "out.fmt", "-o", "out.vtm", "--vdb", "phi.vdb",
               "--report", "out.json", "--threads", 1, cwd=folder)
    check_exit("a sphere to four formats", done, 0, "surface", "rasterize", "sweep", "march",
               "blocks", "io")
    check("standard output is empty", done.stdout == "", done.stdout)
    check("no progress bar without a terminal", "\r" not in done.stderr)
    for name in ["out.xyz", "out.fmt", "out.vtm", "phi.vdb", "out.json"]:
        check(f"{name} is there", (folder / name).is_file())
    check("no temporary file is left", not [f for f in listing(folder) if ".part" in f],
          listing(folder))

    report = json.loads((folder / "out.json").read_text())
    for part, names in KEYS.items():
        missing = [name for name in names if name not in report.get(part, {})]
        check(f"report: {part} has its keys", not missing, missing)
    check("report: six patches, 6 x 8 x 8 x 6 cells", report["surface"]["patches"] == 6
          and report["blocks"]["count"] == 6 and report["blocks"]["cells"] == 6 * 8 * 8 * 6)
    check("report: a welded closed sphere has faces + 2 nodes", report["surface"]["closed"]
          and report["surface"]["nodes"] == report["surface"]["faces"] + 2
          and report["surface"]["free_edges"] == 0)
    march = report["march"]
    check("report: reached + collided + left_band = nodes",
          march["reached"] + march["collided"] + march["left_band"] == march["nodes"], march)
    check("report: the distance is met to 1e-6", march["distance_error_max"] <= 1e-6, march)
    check("report: one row of coverage a patch, all 1", len(report["coverage"]) == 6
          and all(row["min"] > 1 - 1e-6 for row in report["coverage"]), report["coverage"])
    options = report["options"]
    check("report: options as given, defaults included", options["layers"] == 6
          and options["first-cell"] == 0.01 and options["growth"] is None
          and options["weld"] == 0.01 and options["threads"] == 1
          and options["surface"] == ["sphere.xyz"], options)
    check("report: the stages' times add up to no more than the total",
          sum(v for k, v in report["time"].items() if k != "total") <= report["time"]["total"])

    info = run("info", "out.xyz", "--json", cwd=folder)
    blocks = json.loads(info.stdout)["blocks"]
    check("info finds six blocks of 9 x 9 x 7",
          blocks == [{"ni": 9, "nj": 9, "nk": 7}] * 6, blocks)

    again = run("mesh", "sphere.xyz", "--distance", 0.4, "--layers", 6, "--first-cell", 0.01,
                "-o", "two.xyz", "-o", "two.fmt", "-o", "two.vtm", "--vdb", "two.vdb",
                "--threads", 2, "--quiet", cwd=folder)
    check_exit("the same with two threads, quietly", again, 0)
    check("--quiet says nothing", again.stderr == "" and again.stdout == "", again.stderr)
    for kind in ["xyz", "fmt"]:
        check(f"two threads give the same .{kind} byte for byte",
              (folder / f"out.{kind}").read_bytes() == (folder / f"two.{kind}").read_bytes())
    pieces = sorted(p.name for p in (folder / "out").iterdir())
    check("and the same .vts pieces", pieces == sorted(p.name for p in (folder / "two").iterdir())
          and all((folder / "out" / p).read_bytes() == (folder / "two" / p).read_bytes()
                  for p in pieces), pieces)
    # Magic number (8 bytes), three version numbers (4 each), a flag; then a random id of 36.
    fields = [(folder / name).read_bytes() for name in ("phi.vdb", "two.vdb")]
    check("and the same .vdb but for OpenVDB's random file id",
          fields[0][:21] == fields[1][:21] and fields[0][21 + 36:] == fields[1][21 + 36:])

    forced = run("mesh", "sphere.xyz", "--distance", 0.4, "--layers", 6, "--first-cell", 0.01,
                 "-o", "odd.dat", "--format", "plot3d", "--report", "-", cwd=folder)
    check_exit("--format forces a format", forced, 0)
    check("it is the same file", (folder / "odd.dat").read_bytes()
          == (folder / "out.xyz").read_bytes())
    check("--report - prints JSON and nothing else", json.loads(forced.stdout)["blocks"]["count"]
          == 6)

    both = run("mesh", "sphere.xyz", "--distance", 0.3, "--side", "both", "--layers", 3,
               "--growth", 1.1, "-o", "both.xyz", "--report", "both.json", "--quiet", cwd=folder)
    check_exit("--side both", both, 0)
    check("it gives twice the blocks",
          json.loads((folder / "both.json").read_text())["blocks"]["count"] == 12)

    field = run("field", "sphere.xyz", "--distance", 0.4, "-o", "f.vdb", "--report", "f.json",
                cwd=folder)
    check_exit("field", field, 0)
    check("its report has the field and no blocks",
          (lambda r: "field" in r and "blocks" not in r)(
              json.loads((folder / "f.json").read_text())))
    grids = json.loads(run("info", "f.vdb", "--json", cwd=folder).stdout)["grids"]
    check("info finds the grid phi, a level set",
          [g["name"] for g in grids] == ["phi"] and grids[0]["class"] == "level set"
          and grids[0]["active_voxels"] > 0, grids)
    grids = json.loads(run("info", "phi.vdb", "--json", cwd=folder).stdout)["grids"]
    check("with a mesh there is the grid level too",
          sorted(g["name"] for g in grids) == ["level", "phi"], grids)

    few = run("mesh", "sphere.xyz", "--distance", 0.4, "--max-sweeps", 1, "-o", "few.xyz",
              cwd=folder)
    check_exit("a sweep that has not settled", few, 4, "--max-sweeps")

    example(folder, "sphere-pair", "--points", 9, "--gap", 0.4)
    pair = run("mesh", "sphere-pair.xyz", "--distance", 0.5, "--layers", 8, "-o", "pair.xyz",
               "--report", "pair.json", cwd=folder)
    report = json.loads((folder / "pair.json").read_text())
    check("two near spheres collide: a warning with a table",
          pair.returncode in (0, 1) and "warning" in pair.stderr and "stop short" in pair.stderr,
          pair.stderr)
    short = [row["patch"] for row in report["coverage"] if row["min"] < 1 - 1e-6]
    check("the table names every such patch", short and all(p in pair.stderr for p in short))
    bad = report["quality"]["nonpositive_cells"]
    check("exit 1 exactly when a cell is not positive", pair.returncode == (1 if bad else 0),
          (pair.returncode, bad))

    check("and no first cell is off", "first cells" not in pair.stderr, pair.stderr)

    example(folder, "wedge", "--points", 9, "--angle", 10)
    wedge = run("mesh", "wedge.xyz", "--distance", 0.5, "--layers", 12, "--first-cell", 1e-3,
                "-o", "wedge.xyz.out.xyz", "--report", "wedge.json", cwd=folder)
    least = json.loads((folder / "wedge.json").read_text())["quality"]["first_cell"]["min"] / 1e-3
    check("first cells without room are warned of, with the least as in the report",
          least < 0.95 and f"5 % off what was asked, {least:.3g} to" in wedge.stderr,
          (least, wedge.stderr))

    example(folder, "l-bar", "--points", 17)
    bar = run("mesh", "l-bar.xyz", "--distance", 0.3, "--layers", 16, "--first-cell", 1e-3,
              "-o", "bar.xyz", "--report", "bar.json", cwd=folder)
    bad = json.loads((folder / "bar.json").read_text())["quality"]["nonpositive_cells"]
    check("a sharp inner edge: exit 1 exactly when a cell is not positive, and their number",
          bar.returncode == (1 if bad else 0) and (not bad or f"{bad} of" in bar.stderr),
          (bar.returncode, bad, bar.stderr))
    check("the mesh is written all the same", (folder / "bar.xyz").is_file())

    plain = run("mesh", "l-bar.xyz", "--distance", 0.5, "--layers", 32, "--first-cell", 1e-3,
                "--repair", "off", "-o", "plain.xyz", "--report", "plain.json", cwd=folder)
    quality = json.loads((folder / "plain.json").read_text())["quality"]
    named = quality["nonpositive"]
    check_exit("folded cells without repair", plain, 1)
    check("they are named, in the report and in a table",
          len(named) == min(100, quality["nonpositive_cells"]) and
          all(cell["block"] in plain.stderr for cell in named[:10]), plain.stderr)

    example(folder, "torus", "--points", 9)
    several = run("mesh", "sphere.xyz", "torus.xyz", "--distance", 0.05, "--dry-run", "--verbose",
                  cwd=folder)
    check("several surfaces: patches are named after their files",
          "sphere: " in several.stdout and "torus: " in several.stdout,
          several.stdout + several.stderr)

finish()
