"""info and example."""

import json
from pathlib import Path

from _command import DATA, check, check_exit, finish, listing, run, scratch

with scratch() as folder:
    folder = Path(folder)
    names = run("example")
    check_exit("example without a name", names, 0)
    listed = [line.split()[0] for line in names.stdout.splitlines()]
    wanted = ["sphere", "cube", "torus", "l-bar", "u-slot", "sphere-pair", "naca0012-wing",
              "draft-tube", "quarter-cylinder", "wing-on-cylinder", "fuselage", "channel"]
    check("lists the twelve surfaces", all(name in listed for name in wanted), listed)
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
        check(f"{name}: dialect and a surface", "formatted" in found["dialect"]
              and found["surface"]["patches"] == len(found["blocks"]), found)
        is_open = name in ("naca0012-wing", "draft-tube", "quarter-cylinder", "wing-on-cylinder",
                           "fuselage", "channel")
        check(f"{name}: {'open' if is_open else 'closed'}",
              found["surface"]["closed"] != is_open
              and (found["surface"]["free_edges"] > 0) == is_open, found["surface"])
    for name, option, owner in [("cube", ["--gap", 1], "sphere-pair"),
                                ("torus", ["--closed"], "draft-tube"),
                                ("draft-tube", ["--fillet", 0.05], "l-bar and u-slot")]:
        made = run("example", name, *option, "-o", "odd.xyz", cwd=folder)
        check_exit(f"{option[0]} for {name}", made, 2, option[0], name, owner)
    check("and nothing is written", "odd.xyz" not in listing(folder), listing(folder))
    for name, *option in [("sphere-pair", "--gap", 1), ("u-slot", "--fillet", 0.05),
                          ("l-bar", "--fillet", 0)]:
        made = run("example", name, "--points", 5, *option, "-o", "even.xyz", cwd=folder)
        check_exit(f"{option[0]} for {name}", made, 0)
    if "draft-tube" in listed:
        run("example", "draft-tube", "--closed", "--points", 9, "-o", "closed.xyz", cwd=folder)
        found = json.loads(run("info", "closed.xyz", "--json", cwd=folder).stdout or "{}")
        check("draft-tube --closed is closed", found.get("surface", {}).get("closed") is True,
              found)

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
    for name, kind in [("x.vtm", "XML"), ("x.json", "JSON")]:
        check_exit(f"info of {name}", run("info", name, cwd=folder), 3, name, kind, "PLOT3D",
                   "OpenVDB")
    check_exit("info of something else", run("info", "noise.xyz", cwd=folder), 3, "noise.xyz")

    wing = DATA / "plot3d" / "bwb.fmt"
    if wing.is_file():
        shown = run("info", wing)
        for part in ["9 patches", "14105 points", "13457 nodes", "13376 faces"]:
            check(f"bwb.fmt: '{part}'", part in shown.stdout, shown.stdout + shown.stderr)
    else:
        print("skipped: bwb.fmt is not there")

finish()
