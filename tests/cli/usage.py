"""Wrong use is refused before any work, with the option, the value and the rule."""

from _command import check, check_exit, example, finish, listing, run, scratch

with scratch() as folder:
    sphere = example(folder, "sphere", "--points", 9)
    before = listing(folder)

    def mesh(*arguments):
        return run("mesh", *arguments, cwd=folder)

    def sphere_mesh(*arguments):
        return mesh(sphere, "--distance", 0.5, "-o", "out.vtm", *arguments)

    check_exit("no command", run(), 2, "vdb-offset mesh")
    check_exit("an unknown command", run("extrude"), 2, "extrude", "mesh")
    check_exit("a mistyped option", sphere_mesh("--layer", 3), 2, "--layer")
    check_exit("no surface", mesh("--distance", 1, "-o", "a.vtm"), 2, "SURFACE")
    check_exit("no distance", mesh(sphere, "-o", "a.vtm"), 2, "--distance")
    check_exit("no output", mesh(sphere, "--distance", 1), 2, "-o FILE")

    for option, value in [
        ("--distance", "-1"),
        ("--distance", "nan"),
        ("--distance", "wide"),
        ("--layers", "0"),
        ("--layers", "2.5"),
        ("--layers", "20000"),
        ("--first-cell", "-1"),
        ("--growth", "0.5"),
        ("--max-growth", "1"),
        ("--scale", "0"),
        ("--weld", "0.7"),
        ("--voxel", "0"),
        ("--voxel", "nan"),
        ("--memory", "lots"),
        ("--side", "left"),
        ("--sweep-tolerance", "-1"),
        ("--max-sweeps", "0"),
        ("--step", "3"),
        ("--step", "1e-09"),
        ("--threads", "0"),
        ("--threads", "-4"),
    ]:
        if option == "--distance":
            result = mesh(sphere, option, value, "-o", "out.vtm")
        else:
            result = sphere_mesh(option, value)
        check_exit(f"{option} {value}", result, 2, option.lstrip("-"), value)
        check(f"{option} {value}: on standard error only", result.stdout == "", result.stdout)
    for option in ["--layers", "--first-cell", "--scale", "--max-sweeps", "--threads"]:
        check_exit(f"{option} of nothing", sphere_mesh(option, ""), 2, option, "not a number")
    check_exit("--distance of nothing", mesh(sphere, "--distance", "", "-o", "out.vtm"), 2,
               "--distance", "not a number")
    check_exit("an unknown input format", sphere_mesh("--input-format", "tape"), 2, "tape")

    contradiction = sphere_mesh("--layers", 10, "--first-cell", 0.01, "--growth", 1.3)
    check_exit("three wishes that contradict", contradiction, 2, "10", "0.01", "1.3", "0.5",
               "without layers", "without first cell", "without growth")
    check_exit("layers too thick", sphere_mesh("--layers", 100, "--first-cell", 0.1), 2, "at most")
    check_exit("growth too large", sphere_mesh("--layers", 4, "--first-cell", 1e-5), 2, "at least")
    check_exit("last cell alone", sphere_mesh("--last-cell", 0.1), 2, "last cell")

    check_exit("an unknown extension", mesh(sphere, "--distance", 1, "-o", "a.stp"), 2, ".stp",
               ".vtm")
    check_exit("an unknown format", sphere_mesh("--format", "step"), 2, "step", "plot3d")
    check_exit("two outputs of one name", sphere_mesh("-o", "./out.vtm"), 2, "out.vtm", "twice")
    check_exit("report and output of one name", sphere_mesh("--report", "out.vtm"), 2, "twice")
    check_exit("an output that is an input", mesh(sphere, "--distance", 1, "-o", sphere), 2,
               "input")
    check_exit("field to something else than OpenVDB",
               run("field", sphere, "--distance", 1, "-o", "a.vtm", cwd=folder), 2, "vdb")
    check_exit("a folder that is not there", mesh(sphere, "--distance", 1, "-o", "no/a.vtm"), 3,
               "no/a.vtm", "folder")
    check_exit("a folder as output", mesh(sphere, "--distance", 1, "-o", "/tmp"), 2)
    check_exit("report in a folder that is not there", sphere_mesh("--report", "no/r.json"), 3)
    check_exit("a surface that is not there", mesh("none.xyz", "--distance", 1, "-o", "a.vtm"), 3,
               "none.xyz")
    check_exit("a configuration that is not there", sphere_mesh("--config", "none.toml"), 3,
               "none.toml")
    check_exit("a voxel that needs more than the memory",
               sphere_mesh("--voxel", 0.001, "--memory", "50M"), 4, "voxel")
    check_exit("an unknown example", run("example", "teapot", "-o", "t.xyz", cwd=folder), 2,
               "teapot", "sphere")
    check_exit("an example out of range", run("example", "cube", "--points", 1, "-o", "c.xyz",
                                              cwd=folder), 2, "--points", "1")
    check("nothing was written", listing(folder) == before, listing(folder))

    for command in ["mesh", "field", "info", "example"]:
        shown = run(command, "--help")
        check(f"{command} --help on standard output", shown.returncode == 0
              and shown.stdout != "" and shown.stderr == "", shown)
    text = run("mesh", "--help").stdout
    stages = ["surface:", "rasterize:", "sweep:", "march:", "io:", "run:"]
    places = [text.find(stage) for stage in stages]
    check("help groups the options by stage, in the pipeline's order",
          -1 not in places and places == sorted(places), places)
    check("help gives units, ranges and defaults",
          all(part in text for part in ["voxels", "[1, 10000]", "default: 0.01"]), text)
    check("help keeps to 100 columns", max(map(len, text.splitlines())) <= 100, text)
    version = run("--version")
    check("--version", version.returncode == 0 and version.stdout.startswith("vdb-offset "))

finish()
