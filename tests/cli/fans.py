"""Sharp edges opened by --fans: what is said, what is written, and what is refused."""

import json
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch

with scratch() as folder:
    folder = Path(folder)
    example(folder, "cube", "--points", 9)
    spacing = ["--distance", 0.5, "--layers", 12, "--first-cell", 1e-3]

    done = run("mesh", "cube.xyz", *spacing, "--fans", 4, "-o", "fans.xyz", "--report", "fans.json",
               cwd=folder)
    check_exit("a cube with fans", done, 0, "12 fans, 8 corners")
    report = json.loads((folder / "fans.json").read_text())
    surface = report["surface"]
    check("report: fans and corners", (surface["fans"], surface["fan_corners"],
                                       surface["split_patches"]) == (12, 8, 0), surface)
    check("report: 6 faces, 12 edges and 8 corners of 3 blocks", report["blocks"]["count"] == 42)
    names = report["blocks"]["named_faces"]
    check("report: first levels of fans are edges and corners",
          names.get("edge") == 12 and names.get("corner") == 24, names)
    check("report: every cell is positive and the distance is met",
          report["quality"]["nonpositive_cells"] == 0
          and report["march"]["distance_error_max"] <= 1e-6, report["quality"])
    blocks = json.loads(run("info", "fans.xyz", "--json", cwd=folder).stdout)["blocks"]
    sizes = sorted((b["ni"], b["nj"], b["nk"]) for b in blocks)
    check("the file has 6 blocks of 9 x 9, 12 of 5 x 9, 24 of 3 x 3",
          sizes == [(3, 3, 13)] * 24 + [(5, 9, 13)] * 12 + [(9, 9, 13)] * 6, sizes)

    plain = run("mesh", "cube.xyz", *spacing, "-o", "plain.xyz", cwd=folder)
    none = run("mesh", "cube.xyz", *spacing, "--fans", 0, "-o", "none.xyz", cwd=folder)
    check_exit("without fans", plain, 0)
    check("--fans 0 is the same, byte for byte", none.returncode == 0
          and (folder / "plain.xyz").read_bytes() == (folder / "none.xyz").read_bytes())

    dry = run("mesh", "cube.xyz", *spacing, "--fans", 4, "--dry-run", cwd=folder)
    check_exit("--dry-run", dry, 0)
    check("it counts the blocks of fans", "42 blocks" in dry.stdout, dry.stdout)

    for number in (-1, 65):
        refused = run("mesh", "cube.xyz", *spacing, f"--fans={number}", "-o", "no.xyz", cwd=folder)
        check_exit(f"--fans={number}", refused, 2, f"fans = {number}", "[0, 64]")

    example(folder, "l-bar", "--points", 9)
    bad = []
    for repair in ("off", "on"):
        run("mesh", "l-bar.xyz", "--distance", 0.3, "--layers", 16, "--first-cell", 1e-3, "--fans",
            4, "--repair", repair, "-o", "bar.xyz", "--report", "bar.json", cwd=folder)
        bad.append(json.loads((folder / "bar.json").read_text())["quality"]["nonpositive_cells"])
    check("fans that end at an inner edge: repair leaves no more bad cells than the march",
          bad[1] <= bad[0], bad)

finish()
