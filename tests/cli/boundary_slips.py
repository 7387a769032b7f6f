"""Slips with --boundary, --internal and --plane: each is named, none is a file's trouble."""

import json
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch


def sheet(file, z, x=(-1, 5)):
    points = [(a, b, z) for b in (-1, 2) for a in x]
    values = [str(p[axis]) for axis in range(3) for p in points]
    file.write_text("1\n2 2 1\n" + "\n".join(values) + "\n")
    return file


def curve(file, y):
    points = [(0.25 * n - 1, y, 0) for n in range(9)]
    values = [str(p[axis]) for axis in range(3) for p in points]
    file.write_text("1\n9 1 1\n" + "\n".join(values) + "\n")
    return file


with scratch() as folder:
    folder = Path(folder)
    channel = folder / "channel.cgns"
    check_exit("example channel", run("example", "channel", "--points", 5, "-o", channel), 0)
    circle = example(folder, "circle", "--points", 9)
    high = sheet(folder / "high.fmt", 0.9)

    def mesh(*options, surface=channel):
        return run("mesh", surface, "--distance", 0.2, "--layers", 4, "--first-cell", 0.02, "-o",
                   folder / "out.cgns", *options)

    for option in ("--internal", "--boundary"):
        for text, said in ((":x", "no file is named"), (f"{high}:", "behind the colon"),
                           (f"{high}: ", "behind the colon"), ("", "no file is named"),
                           (":", "behind the colon")):
            check_exit(f"{option} '{text}'", mesh(option, text), 2, f"{option} {text}: ", said)
        check_exit(f"{option}: a file that is none", mesh(option, "none.fmt:x"), 3, "none.fmt")
        for name in ("upper", "step", "lower", "outer", "wall"):
            check_exit(f"{option} called {name}", mesh(option, f"{high}:{name}"), 2,
                       f"cannot be called '{name}'", "give it another")
        line = curve(folder / "line.fmt", 0.6)
        check_exit(f"{option}: a curve beside surfaces", mesh(option, f"{line}:x"), 2,
                   "'x' is made of curves")
        check_exit(f"{option}: a surface beside curves",
                   mesh(option, f"{high}:x", surface=circle), 2, "'x' is made of surfaces")
    check_exit("a plane called as a family", mesh("--plane", "x=0:upper"), 2,
               "cannot be called 'upper'")
    check_exit("a sheet that is the wall", mesh("--internal", f"{channel}:sheet"), 2, "'sheet'",
               "lies on the wall", "lower upstream")
    check_exit("a sheet on part of the wall",
               mesh("--internal", f"{sheet(folder / 'on.fmt', 1.0)}:lid"), 2, "'lid'", "upper")
    for file, surface in ((channel, channel), (circle, circle)):
        check_exit(f"the wall of {surface.name} as its boundary",
                   mesh("--boundary", f"{file}:end", surface=surface), 2, "boundary 'end'",
                   "lies on the wall")
    check_exit("a boundary on part of the wall",
               mesh("--boundary", f"{sheet(folder / 'on.fmt', 1.0)}:lid"), 2, "'lid'", "upper",
               "leave out of it")
    # The channel is open at x = 0 and 4, y = 0 and .5; a millionth of its size, 4.1, passes.
    for spec, off in (("x=-1e-5", "1e-05"), ("y=-0.25", "0.25")):
        check_exit(f"--plane {spec}", mesh("--plane", f"{spec}:end"), 0,
                   "no free edge lies on 'end'", f"the nearest is off it by {off}, and 4.1",
                   "1e-06 of the size")
    check_exit("a plane a little within", mesh("--plane", "x=1e-5:end"), 2, "cuts the surface",
               "as far as (0,", "the nearest free edges are 1e-05 off it, and 4.1")
    check("one well within is no such slip",
          "would do" not in mesh("--plane", "x=2.1:end").stderr)
    bare = mesh("--family", "step:layers=off", "-o", f"{folder}/bare/", "--report",
                folder / "report.json")
    check_exit("a wall without layers", bare, 0, "'step' (wall without layers")
    report = json.loads((folder / "report.json").read_text())
    kind = {one["name"]: one["kind"] for one in report["surface"]["boundaries"]}["step"]
    check("is a wall in the report, with its condition",
          kind == "wall" and report["blocks"]["conditions"]["step"] == "wall", report["blocks"])
    text = (folder / "bare/constant/polyMesh/boundary").read_text()
    kind = text.split("step\n")[1].split("type")[1].split(";")[0].strip()
    check("and in OpenFOAM", kind == "wall", text)
    far = mesh("--internal", f"{sheet(folder / 'far.fmt', 0.6)}:far")
    check_exit("a sheet beyond the layers", far, 0, "warning", "'far'")
    near = mesh("--internal", f"{high}:near")
    check_exit("a sheet within the layers", near, 0)
    check("is met", "no column ends on" not in near.stderr, near.stderr)
    named = mesh("--internal", f"{high}:inlet-screen", "-o", folder / "out.su2", "--report",
                 folder / "report.json")
    check_exit("a sheet called inlet-screen", named, 0)
    text = (folder / "report.json").read_text()
    check("has flow on both sides: it is no inflow", '"inlet-screen": "unspecified"' in text, text)

finish()
