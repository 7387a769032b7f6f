"""Every form of --plane that is read, and every slip that is refused by naming it."""

import json
from pathlib import Path

from _command import check, check_exit, example, finish, run, scratch

with scratch() as folder:
    file = example(folder, "channel", "--points", 5)

    def plane(*specs):
        options = [part for spec in specs for part in ("--plane", spec)]
        return run("mesh", file, "--distance", 0.1, "--layers", 4, "--first-cell", 0.02, *options,
                   "-o", "out.fmt", "--report", "out.json", cwd=folder)

    for spec in ["x=0:inlet", "X=0:inlet", " x = 0 : inlet ", "x=-0.0:inlet", "x=0e5:inlet",
                 "0,0,0/1,0,0:inlet", " 0, 0 ,0 / -2 , 0, 0 : inlet", "X\t=\t0:inlet"]:
        check_exit(f"'{spec}'", plane(spec), 0)
        report = json.loads((Path(folder) / "out.json").read_text())
        check(f"'{spec}' is the inlet", '"inlet"' in json.dumps(report), report)
    for spec, named in [("x=0abc", "'0abc'"), ("x=0 1", "'0 1'"), ("x=", "''"), ("x=nan", "'nan'"),
                        ("w=0", "'w'"), ("xy=0", "'xy'"), ("=0", "''"), ("x", "'='"),
                        ("x=0:", "colon"), ("x=0: ", "colon"), ("0,0/1,0,0", "point"),
                        ("0,0,0,0/1,0,0", "point"), ("0,0,0/1,0", "normal"),
                        ("0,0,0/1,0,0x", "'0x'"), ("0,0,0/0,0,0", "no length"),
                        ("0,0,0/1,0,0/1", "'0/1'"), ("x=0x", "'0x'")]:
        check_exit(f"'{spec}'", plane(spec), 2, f"--plane {spec}: ", named)

finish()
