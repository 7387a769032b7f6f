"""--config and --dry-run."""

import os
from pathlib import Path

from _command import DATA, check, check_exit, example, finish, listing, run, scratch

with scratch() as folder:
    folder = Path(folder)
    example(folder, "sphere", "--points", 9)
    (folder / "run.toml").write_text(
        '# layers\ndistance = 0.4\nlayers = 6\nfirst-cell = 0.01\noutput = ["a.xyz", "b.fmt"]\n'
        'quiet = true\n')
    before = listing(folder)

    plan = run("mesh", "sphere.xyz", "--distance", 0.4, "--layers", 6, "--dry-run", cwd=folder)
    check_exit("--dry-run needs no output", plan, 0)
    for part in ["6 patches", "486 points", "386 nodes", "384 faces", "6 blocks", "2304 cells",
                 "voxel", "6 layers", "growth 1.2", "expected", "allowed"]:
        check(f"--dry-run prints '{part}' on standard output", part in plan.stdout, plan.stdout)
    check("--dry-run says which rule chose the voxel",
          "median surface edge" in plan.stdout or "twelfth" in plan.stdout, plan.stdout)
    given = run("mesh", "sphere.xyz", "--distance", 0.4, "--voxel", 0.05, "--dry-run", cwd=folder)
    check("--dry-run with a voxel: as given", "0.05 (as given)" in given.stdout, given.stdout)
    solved = run("mesh", "sphere.xyz", "--distance", 1, "--first-cell", 0.01, "--growth", 1.2,
                 "--dry-run", cwd=folder)
    check("--dry-run shows the growth requested and the growth solved",
          "17 layers" in solved.stdout and "(requested 1.2)" in solved.stdout, solved.stdout)
    check("--dry-run writes nothing", listing(folder) == before, listing(folder))
    plan = run("field", "sphere.xyz", "--distance", 0.4, "--dry-run", cwd=folder)
    check("field --dry-run", plan.returncode == 0 and "voxel" in plan.stdout, plan)

    done = run("mesh", "sphere.xyz", "--config", "run.toml", cwd=folder)
    check_exit("--config gives the options", done, 0)
    check("it is as quiet as the file says", done.stderr == "", done.stderr)
    check("both outputs are there", {"a.xyz", "b.fmt"} <= set(listing(folder)), listing(folder))
    plain = run("mesh", "sphere.xyz", "--distance", 0.4, "--layers", 6, "--first-cell", 0.01,
                "-o", "c.xyz", cwd=folder)
    check_exit("the same by options", plain, 0)
    check("gives the same file",
          (folder / "a.xyz").read_bytes() == (folder / "c.xyz").read_bytes())
    over = run("mesh", "sphere.xyz", "--config", "run.toml", "--layers", 9, "--dry-run", cwd=folder)
    check("the command line goes before the file", "9 layers" in over.stdout, over.stdout)
    (folder / "odd.toml").write_text("distance = 0.4\nlayer = 6\n")
    odd = run("mesh", "sphere.xyz", "--config", "odd.toml", "-o", "d.xyz", cwd=folder)
    check_exit("an unknown key", odd, 2, "'layer'", "odd.toml, line 2")
    (folder / "bad.toml").write_text("distance = 0.4\nlayers = six\n")
    bad = run("mesh", "sphere.xyz", "--config", "bad.toml", "-o", "d.xyz", cwd=folder)
    check_exit("a value of the wrong type", bad, 2, "layers", "six", "bad.toml, line 2")
    for text, parts in [
        ("# wide\ndistance = -1\n", ["odd.toml, line 2", "distance = -1"]),
        ("distance = 1\n\nlayers = 0\n", ["odd.toml, line 3", "layers = 0"]),
        ("distance = 1\nstep = 3\n", ["odd.toml, line 2", "step = 3"]),
        ("distance = 1\nmemory = \"lots\"\n", ["odd.toml, line 2", "memory", "lots"]),
        ("distance = \"\"\n", ["odd.toml, line 1", "not a number"]),
        ("[run]\ndistance = 1\n", ["odd.toml, line 1", "[run]"]),
        ("config = \"run.toml\"\n", ["odd.toml, line 1", "config"]),
    ]:
        (folder / "odd.toml").write_text(text)
        odd = run("mesh", "sphere.xyz", "--config", "odd.toml", "-o", "d.xyz", cwd=folder)
        check_exit(f"configuration {text!r}", odd, 2, *parts)
    (folder / "odd.toml").write_text("distance = -2\n")
    over = run("mesh", "sphere.xyz", "--config", "odd.toml", "--distance", -1, "-o", "d.xyz",
               cwd=folder)
    check("an error of the command line does not name the file",
          over.returncode == 2 and "odd.toml" not in over.stderr, over.stderr)
    (folder / "all.toml").write_text('surface = ["sphere.xyz"]\ndistance = 0.4\nlayers = 6\n')
    plan = run("mesh", "--config", "all.toml", "--dry-run", cwd=folder)
    check("surface is a key too", plan.returncode == 0 and "486 points" in plan.stdout, plan)
    (folder / "all.toml").write_text('surface = "none.xyz"\ndistance = 0.4\n')
    plan = run("mesh", "sphere.xyz", "--config", "all.toml", "--dry-run", cwd=folder)
    check("and the command line goes before it", "486 points" in plan.stdout, plan)

    os.mkfifo(folder / "fifo.toml")
    check_exit("a configuration that would wait for ever",
               run("mesh", "sphere.xyz", "--config", "fifo.toml", cwd=folder, timeout=30), 2,
               "fifo.toml", "not a regular file")

    wing = DATA / "plot3d" / "bwb.fmt"
    if wing.is_file():
        plan = run("mesh", wing, "--distance", 2, "--layers", 48, "--first-cell", 1e-4,
                   "--dry-run")
        for part in ["9 patches", "14105 points", "13457 nodes", "13376 faces", "9 blocks",
                     "642048 cells"]:
            check(f"bwb.fmt: '{part}'", part in plan.stdout, plan.stdout + plan.stderr)
    else:
        print("skipped: bwb.fmt is not there")

finish()
