"""What is in the place of an output: links are followed, all else but a file is refused."""

import os
import socket
import stat
from pathlib import Path

from _command import check, check_exit, example, finish, listing, run, scratch

with scratch() as folder:
    folder = Path(folder)
    sphere = example(folder, "sphere", "--points", 5)

    def mesh(*arguments):
        return run("mesh", sphere, "--distance", 0.3, "--layers", 2, *arguments, cwd=folder)

    check_exit("a plain output", mesh("-o", "plain.fmt", "-o", "plain.vtm"), 0)

    os.mkfifo(folder / "fifo.fmt")
    server = socket.socket(socket.AF_UNIX)
    server.bind(str(folder / "socket.fmt"))
    (folder / "folder.fmt").mkdir()
    os.symlink("fifo.fmt", folder / "tofifo.fmt")
    os.mkfifo(folder / "report.json")
    before = listing(folder)
    for name, kind in [("fifo.fmt", "FIFO"), ("socket.fmt", "socket"), ("folder.fmt", "folder"),
                       ("tofifo.fmt", "FIFO")]:
        for made in [mesh("-o", name), run("example", "cube", "-o", name, cwd=folder)]:
            check_exit(f"onto a {kind}, {name}", made, 3, name, kind, "give the name")
            check(f"{name}: refused before any work", "surface " not in made.stderr, made.stderr)
    refused = mesh("-o", "a.fmt", "--report", "report.json")
    check_exit("a report onto a FIFO", refused, 3, "report.json", "FIFO")
    check("refused before any work", "surface " not in refused.stderr, refused.stderr)
    check("all is as it was", listing(folder) == before, listing(folder))
    for name in ["fifo.fmt", "report.json"]:
        check(f"{name} is a FIFO still", stat.S_ISFIFO(os.lstat(folder / name).st_mode))

    (folder / "far").mkdir()
    (folder / "far" / "old.fmt").write_text("old")
    (folder / "far" / "old.fmt").chmod(0o640)
    os.symlink("far/old.fmt", folder / "link.fmt")
    os.symlink("far/new.json", folder / "link.json")
    os.symlink("far/new.vtm", folder / "link.vtm")
    check_exit("through links", mesh("-o", "link.fmt", "-o", "link.vtm", "--report", "link.json"),
               0)
    for name in ["link.fmt", "link.json", "link.vtm"]:
        check(f"{name} is a link still", (folder / name).is_symlink())
    check("the target is what was written", (folder / "far" / "old.fmt").read_bytes()
          == (folder / "plain.fmt").read_bytes())
    check("and keeps its permissions",
          stat.S_IMODE((folder / "far" / "old.fmt").stat().st_mode) == 0o640)
    check("a link to nothing makes its target", (folder / "far" / "new.json").is_file())
    check("pieces lie beside the target, where its index looks",
          (folder / "far" / "new" / "block_0.vts").is_file()
          and 'file="new/block_0.vts"' in (folder / "far" / "new.vtm").read_text(),
          listing(folder))

    (folder / "taken").mkdir()
    (folder / "taken" / "notes.txt").write_text("mine")
    os.symlink("plain", folder / "linked")
    for name, part in [("taken.vtm", "notes.txt"), ("linked.vtm", "linked")]:
        refused = mesh("-o", name)
        check_exit(f"a folder of pieces that is not ours, {name}", refused, 3, part)
        check(f"{name}: refused before any work", "surface " not in refused.stderr, refused.stderr)

    os.symlink("one.fmt", folder / "same.json")
    for outputs in [["-o", "one.fmt", "--report", "same.json"],
                    ["-o", "rep.vtm", "--report", "rep"]]:
        refused = mesh(*outputs)
        check_exit(f"two outputs in one place: {' '.join(outputs)}", refused, 2, "output")
        check("refused before any work", "surface " not in refused.stderr, refused.stderr)

    config = folder / "run.toml"
    config.write_text("layers = 2\n")
    body = example(folder, "cube", "--points", 5)
    os.symlink("cube.xyz", folder / "link.xyz")
    for options, output in [(["--config", "run.toml"], ["-o", "run.toml", "--format", "cgns"]),
                            (["--boundary", "cube.xyz:body"], ["-o", "cube.xyz"]),
                            (["--internal", "cube.xyz"],
                             ["-o", "x.fmt", "--topology", "link.xyz"])]:
        inputs = config.read_bytes() + body.read_bytes()
        check_exit(f"onto what {options[0]} reads", mesh(*options, *output), 2, "is an input too")
        check("it is as it was", config.read_bytes() + body.read_bytes() == inputs)
    check_exit("a mesh to check", mesh("-o", "plain.xyz", "-o", "plain.nmf"), 0)
    for name in ("plain.xyz", "plain.nmf"):
        before = (folder / name).read_bytes()
        made = run("check", "plain.xyz", "--report", name, cwd=folder)
        check_exit(f"a report onto the mesh, {name}", made, 2, "is an input too")
        check("it is as it was", (folder / name).read_bytes() == before)

finish()
