"""Slips with --boundary, --internal and --plane: each is named, none is a file's trouble."""

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
