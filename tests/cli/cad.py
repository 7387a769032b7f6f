"""CAD models to meshes: the tool's own STEP, and models of others where they are there."""

import json
import shutil
import subprocess
from pathlib import Path

from _command import COMMAND, DATA, check, check_exit, finish, run, scratch, skip

USUAL = ("--layers", 12, "--quiet")


def meshed(name, surface, folder, distance, first_cell, *more):
    report = folder / f"{name}.json"
    made = run("mesh", surface, "--distance", distance, "--first-cell", first_cell, *USUAL, "-o",
               folder / f"{name}.cgns", "--report", report, *more)
    check_exit(f"mesh of {name}", made, 0)
    return json.loads(report.read_text())


with scratch() as folder:
    folder = Path(folder)
    sphere = folder / "sphere.xyz"
    check_exit("example", run("example", "sphere", "--points", 17, "-o", sphere), 0)
    step = folder / "outer.step"
    made = run("mesh", sphere, "--distance", 0.2, "--first-cell", 0.05, "--layers", 4, "--quiet",
               "-o", folder / "s.xyz.p3d", "--outer-surface", step)
    if "no OpenCASCADE" in made.stderr:
        skip("built without OpenCASCADE")
    check_exit("outermost level as STEP", made, 0)

    info = json.loads(run("info", step, "--json").stdout)
    check("six faces, closed", info["surface"]["patches"] == 6 and info["surface"]["closed"])
    # A sphere of radius 1.2, of facets.
    check("its area is the sphere's", abs(info["surface"]["area"] / 18.0956 - 1) < 0.005)
    coarse = meshed("coarse", step, folder, 0.1, 0.005, "--surface-size", 0.3)
    fine = meshed("fine", step, folder, 0.1, 0.005, "--surface-size", 0.1)
    check("no cell is bad", coarse["quality"]["nonpositive_cells"] == 0
          and fine["quality"]["nonpositive_cells"] == 0)
    check("a smaller size gives more cells",
          fine["blocks"]["cells"] > 4 * coarse["blocks"]["cells"])

    # A program without its module beside it, as a part of an installation that is copied.
    alone = folder / "alone" / "vdb-offset"
    alone.parent.mkdir()
    shutil.copy(shutil.which(COMMAND), alone)
    for more in ((), ("--dry-run",)):
        said = subprocess.run(
            [alone, "mesh", sphere, "--distance", "0.2", "-o", folder / "a.p3d", "--outer-surface",
             folder / "a.step", *more], capture_output=True, text=True)
        if said.returncode == 0 and (folder / "a.step").exists():
            print("part skipped: the module is installed where it was to be")
            break
        check(f"a module that is missing is named before the run {more}",
              said.returncode == 3 and "a.step" in said.stderr and "libvdb" in said.stderr
              and "march" not in said.stderr, said.stderr)
        check("and nothing is written", not list(folder.glob("a.*")))

    broken = folder / "broken.step"
    broken.write_bytes(step.read_bytes()[:3000])
    refused = run("mesh", broken, "--distance", 0.1, "-o", folder / "b.vtm")
    check_exit("a STEP file that breaks off", refused, 3)
    check("is named", "broken.step" in refused.stderr, refused.stderr)
    check("leaves nothing", not (folder / "b.vtm").exists())

    models = DATA / "cad"
    if not models.exists():
        print("part skipped: ../shared/data/cad is absent")
    else:
        for name, distance, first_cell in (("tigl_nacelle.stp", 200, 0.2),
                                           ("dealii_wigley.iges", 0.2, 2e-4),
                                           ("dealii_goteborg.step", 0.3, 3e-4),
                                           ("tigl_simplewing.brep", 0.1, 1e-4)):
            report = meshed(name, models / name, folder, distance, first_cell)
            check(f"{name}: no cell is bad", report["quality"]["nonpositive_cells"] == 0)
            check(f"{name}: structured",
                  run("check", folder / f"{name}.cgns").returncode == 0)
finish()
