"""--topology: what it holds, and that a mesh of it is the mesh that it was written with."""

import json
from pathlib import Path

from _command import check, check_exit, finish, run, scratch

USUAL = ("--distance", 0.05, "--layers", 3, "--quiet")


def same(a, b):
    return a.read_bytes() == b.read_bytes()


with scratch() as folder:
    folder = Path(folder)
    cases = {"cube": (), "u-slot": ("--fillet", 0.05), "star": (), "quarter-cylinder": (),
             "channel": (), "draft-tube": (), "airfoil": (), "circle": ()}
    further = {"star": ("--fans", 2), "cube": ("--side", "both", "--scale", 0.3),
               "channel": ("--plane", "x=0:inlet", "--family", "step:layers=off"),
               "draft-tube": ("--bc", "pier:inviscid-wall",)}
    repeat = {"cube": ("--side", "both"), "channel": ("--family", "step:layers=off")}
    for name, shape in cases.items():
        surface = folder / f"{name}.xyz"
        if name not in ("airfoil", "circle"):
            surface = folder / f"{name}.cgns"
        check_exit(f"example {name}",
                   run("example", name, "-o", surface, "--points", 9, *shape), 0)
        document = folder / f"{name}.json"
        options = further.get(name, ())
        first, second = folder / f"{name}-1.p3d", folder / f"{name}-2.p3d"
        made = run("mesh", surface, "-o", first, "-o", first.with_suffix(".vtm"), "--topology",
                   document, *USUAL, *options)
        check(f"mesh {name} with its topology", made.returncode in (0, 1), made.stderr)
        again = folder / f"{name}-again.json"
        made = run("mesh", document, "-o", second, "--topology", again, *USUAL,
                   *repeat.get(name, options))
        check(f"mesh {name} of its topology", made.returncode in (0, 1), made.stderr)
        check(f"{name}: the same mesh, bit for bit", same(first, second))
        check(f"{name}: the same document, bit for bit", same(document, again))

        held = json.loads(document.read_text())
        check(f"{name}: every face has one interface or boundary face",
              all((f["interface"] < 0) != (f["boundary_face"] < 0) for f in held["faces"]))
        used = [0] * len(held["faces"])
        for block in held["blocks"]:
            for faces in block["faces"].values():
                for face in faces:
                    used[face] += 1
        check(f"{name}: a face bounds two blocks where it is an interface, else one",
              used == [2 if f["interface"] >= 0 else 1 for f in held["faces"]])

    said = run("info", folder / "channel.json")
    check_exit("info of a document", said, 0)
    check("it counts blocks and names", "topology document" in said.stdout
          and "inlet" in said.stdout, said.stdout)
    said = json.loads(run("info", "--json", folder / "cube.json").stdout)
    check("as JSON too", (said["format"], said["blocks"], said["surface"]["patches"])
          == ("topology", 12, 6), said)

    stranger = folder / "report.json"
    stranger.write_text('{"surface": {}}')
    check_exit("JSON of another kind", run("info", stranger), 3, "report.json",
               "no topology document")
    check_exit("meshing it", run("mesh", stranger, "-o", folder / "no.xyz", *USUAL), 3,
               "no topology document")
    check_exit("checking it", run("check", stranger), 3, "no topology document",
               "mesh writes one with --topology")
    stranger.write_text("hello")
    check_exit("what is no JSON", run("info", stranger), 3,
               "is no JSON, as a topology document is")
    check_exit("checking a topology document", run("check", folder / "cube.json"), 2,
               "holds no cells")
    check_exit("into its own input", run("mesh", folder / "cube.json", "-o", folder / "no.xyz",
                                         "--topology", folder / "cube.json", *USUAL), 2,
               "is an input too")
    check_exit("a folder that is missing", run("mesh", folder / "cube.cgns", "-o",
                                               folder / "no.xyz", "--topology",
                                               folder / "none/x.json", *USUAL), 3, "none")

finish()
