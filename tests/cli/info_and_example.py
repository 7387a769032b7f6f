"""info and example."""

import json
from pathlib import Path

from _command import DATA, check, check_exit, finish, listing, run, scratch

with scratch() as folder:
    folder = Path(folder)
    names = run("example")
    check_exit("example without a name", names, 0)
    listed = [line.split()[0] for line in names.stdout.splitlines()]
    wanted = ["sphere", "cube", "torus", "bumpy-torus", "l-bar", "u-slot", "wedge", "star",
              "sphere-pair",
              "naca0012-wing", "draft-tube", "quarter-cylinder", "wing-on-cylinder", "fuselage",
              "channel", "airfoil", "circle"]
    curves = ["airfoil", "circle"]
    check("lists the seventeen surfaces and curves", all(name in listed for name in wanted), listed)
    check_exit("example without an output", run("example", "cube"), 2, "-o")
    check_exit("an example as VTK", run("example", "cube", "-o", "c.vtm", cwd=folder), 2, ".vtm")

    for name in listed:
        made = run("example", name, "--points", 9, "-o", f"{name}.fmt", cwd=folder)
        check_exit(f"example {name}", made, 0)
        shown = run("info", f"{name}.fmt", "--json", cwd=folder)
        check_exit(f"info {name}", shown, 0)
        if shown.returncode != 0:
            continue
        found = json.loads(shown.stdout)
        if name in curves:
            check(f"{name}: dialect and closed curves", "2-D" in found["dialect"]
                  and found["curves"]["patches"] == len(found["blocks"])
                  and found["curves"]["closed"] and found["curves"]["free_ends"] == 0, found)
            continue
        check(f"{name}: dialect and a surface", "formatted" in found["dialect"]
              and found["surface"]["patches"] == len(found["blocks"]), found)
        is_open = name in ("naca0012-wing", "draft-tube", "quarter-cylinder", "wing-on-cylinder",
                           "fuselage", "channel")
        check(f"{name}: {'open' if is_open else 'closed'}",
              found["surface"]["closed"] != is_open
              and (found["surface"]["free_edges"] > 0) == is_open, found["surface"])
    for name, option, owner in [("cube", ["--gap", 1], "sphere-pair"),
                                ("torus", ["--closed"], "draft-tube"),
                                ("draft-tube", ["--fillet", 0.05], "l-bar and u-slot"),
                                ("star", ["--angle", 30], "wedge"),
                                ("wedge", ["--tips", 4], "star"),
                                ("circle", ["--naca", "0012"], "airfoil")]:
        made = run("example", name, *option, "-o", "odd.xyz", cwd=folder)
        check_exit(f"{option[0]} for {name}", made, 2, option[0], name, owner)
    check("and nothing is written", "odd.xyz" not in listing(folder), listing(folder))
    for name, *option in [("sphere-pair", "--gap", 1), ("u-slot", "--fillet", 0.05),
                          ("wedge", "--angle", 170), ("star", "--tips", 12),
                          ("l-bar", "--fillet", 0)]:
        made = run("example", name, "--points", 5, *option, "-o", "even.xyz", cwd=folder)
        check_exit(f"{option[0]} for {name}", made, 0)
    if "draft-tube" in listed:
        run("example", "draft-tube", "--closed", "--points", 9, "-o", "closed.xyz", cwd=folder)
        found = json.loads(run("info", "closed.xyz", "--json", cwd=folder).stdout or "{}")
        check("draft-tube --closed is closed", found.get("surface", {}).get("closed") is True,
              found)

    made = run("example", "airfoil", "--naca", "2412", "-o", "a.dat", "-o", "a.xyz", cwd=folder)
    check_exit("an airfoil as Selig text and as PLOT3D", made, 0)
    text = json.loads(run("info", "a.dat", "--json", cwd=folder).stdout)
    grid = json.loads(run("info", "a.xyz", "--json", cwd=folder).stdout)
    check("both hold the same curves", text["airfoil"]["blunt"]
          and all(text["curves"][key] == grid["curves"][key]
                  for key in ("patches", "points", "closed", "bounds", "length")), (text, grid))
    shown = run("info", "a.dat", cwd=folder)
    for part in ["airfoil: Selig", "title      airfoil", "65 in the file", "blunt, its base",
                 "chord 1", "2 patches", "closed", "0 free ends"]:
        check(f"info of a .dat prints '{part}'", part in shown.stdout, shown.stdout)
    (folder / "l.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n")
    shown = run("info", "l.obj", cwd=folder)
    for part in ["Wavefront .obj", "3 points, open", "length 2", "2 free ends"]:
        check(f"info of an .obj prints '{part}'", part in shown.stdout, shown.stdout)
    (folder / "coordinates").write_bytes((folder / "a.dat").read_bytes())
    check_exit("an airfoil of no extension, by --input-format",
               run("info", "coordinates", "--input-format", "airfoil", cwd=folder), 0)
    check_exit("a surface as airfoil coordinates",
               run("example", "cube", "-o", "c.dat", cwd=folder), 2, "c.dat", "6 patches")
    check_exit("a section that is none", run("example", "airfoil", "--naca", "12", "-o", "b.dat",
                                             cwd=folder), 2, "--naca", "four digits")
    run("example", "cube", "--points", 5, "-o", "cube.xyz", cwd=folder)
    check_exit("curves and surfaces in one run",
               run("mesh", "a.dat", "cube.xyz", "--distance", 0.1, "-o", "m.vtm", cwd=folder), 2,
               "a.dat holds curves, and cube.xyz surfaces")

    run("example", "sphere", "--points", 9, "-o", "s.fmt", "-o", "s.xyz", cwd=folder)
    text = json.loads(run("info", "s.fmt", "--json", cwd=folder).stdout)
    binary = json.loads(run("info", "s.xyz", "--json", cwd=folder).stdout)
    check("both dialects hold the same surface", text["surface"] == binary["surface"],
          (text, binary))
    bounds = binary["surface"]["bounds"]
    check("a sphere is as wide in y and z as in x", all(
        abs((bounds["max"][a] - bounds["min"][a]) - (bounds["max"][0] - bounds["min"][0]))
        <= 1e-12 for a in (1, 2)), bounds)
    shown = run("info", "s.xyz", cwd=folder)
    for part in ["PLOT3D", "9 x 9 x 1", "6 patches", "386 nodes", "384 faces", "closed",
                 "0 free edges", "shortest"]:
        check(f"info prints '{part}'", part in shown.stdout, shown.stdout)

    check_exit("info of nothing", run("info", "none.xyz", cwd=folder), 3, "none.xyz")
    run("field", "s.xyz", "--distance", 0.2, "-o", "whole.vdb", cwd=folder)
    whole = (folder / "whole.vdb").read_bytes()
    for part in [20, 300, len(whole) // 2]:
        (folder / "cut.vdb").write_bytes(whole[:part])
        check_exit(f"info of an OpenVDB file cut after {part} bytes",
                   run("info", "cut.vdb", cwd=folder), 3, "cut.vdb")
    (folder / "noise.xyz").write_bytes(b"once upon a time")
    (folder / "x.vtm").write_text('<?xml version="1.0"?>\n<VTKFile/>\n')
    (folder / "x.json").write_text('{"surface": {}}\n')
    (folder / "x.vtp").write_text('<?xml version="1.0"?>\n<VTKFile/>\n')
    for name, words in [("x.vtm", ["vtkMultiBlockDataSet"]), ("x.json", ["topology document"]),
                        ("x.vtp", ["XML", "PLOT3D", "OpenVDB"])]:
        check_exit(f"info of {name}", run("info", name, cwd=folder), 3, name, *words)
    check_exit("info of something else", run("info", "noise.xyz", cwd=folder), 3, "noise.xyz")

    wing = DATA / "plot3d" / "bwb.fmt"
    if wing.is_file():
        shown = run("info", wing)
        for part in ["9 patches", "14105 points", "13457 nodes", "13376 faces"]:
            check(f"bwb.fmt: '{part}'", part in shown.stdout, shown.stdout + shown.stderr)
    else:
        print("skipped: bwb.fmt is not there")

finish()
