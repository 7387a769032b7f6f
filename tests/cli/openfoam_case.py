"""The OpenFOAM case: fans, names and conditions; what is in the place is not destroyed."""

import shutil
from pathlib import Path

from _command import check, check_exit, finish, listing, run, scratch
from _openfoam import judged, note, patches

# Distance, first cell and layers that keep aspect ratios below checkMesh's limit, 1000.
USUAL = ("--distance", 0.05, "--first-cell", 0.005, "--layers", 5)


def mesh(surface, out, *options):
    made = run("mesh", surface, "-o", out, "--quiet", *USUAL, *options)
    check_exit(f"mesh {Path(surface).stem} {' '.join(map(str, options))}", made, 0)


def surface(folder, name):
    file = folder / f"{name}.cgns"
    check_exit(f"example {name}", run("example", name, "-o", file, "--points", 9), 0)
    return file


with scratch() as folder:
    folder = Path(folder)
    cube, channel = surface(folder, "cube"), surface(folder, "channel")
    mesh(cube, f"{folder / 'cube'}/")
    mesh(channel, f"{folder / 'channel'}/")
    for fans in (2, 3):
        case = folder / f"fans-{fans}"
        mesh(cube, case / "cube.foam", "--fans", fans)
        judged(case)
        check("FOLDER/NAME.foam is written, for ParaView", (case / "cube.foam").exists(),
              listing(case))
    facts = note(folder / "fans-2")
    # A closed surface of n quads has n + 2 points. Fans add quads to each level's upper surface:
    # as many points as cells, and none on the first level, where they have no area.
    wall = note(folder / "cube")
    check("points on first levels of fans are those of the wall",
          facts["nPoints"] - wall["nPoints"] == facts["nCells"] - wall["nCells"] > 0,
          (facts, wall))

    case = folder / "channel"
    own = case / "system/controlDict"
    own.write_text(own.read_text() + "// mine\n")
    mesh(channel, f"{case}/", "--bc", "upper:inviscid-wall", "--outer", "overset", "--plane",
         "x=0:inlet 1")
    judged(case)
    sets = case / "constant/polyMesh/sets"
    sets.mkdir(exist_ok=True)
    for name in ("region0", "region12", "highAspectRatioCells"):
        (sets / name).write_text("left by checkMesh")  # the channel's two walls are two regions
    mesh(channel, f"{case}/", "--bc", "upper:inviscid-wall", "--outer", "overset", "--plane",
         "x=0:inlet 1")
    check("sets that checkMesh leaves go with the mesh", not sets.exists(), listing(case))
    for name in ("region", "regions1", "region1a", "mine"):
        sets.mkdir()
        (sets / name).write_text("mine")
        made = run("mesh", channel, "-o", f"{case}/", *USUAL)
        check_exit(f"a set of one's own, {name}, is not destroyed", made, 3, "sets")
        shutil.rmtree(sets)
    kinds = {name: kind for name, (kind, _, _) in patches(case).items()}
    check("an inviscid wall is a patch, and names become words",
          kinds["upper"] == "patch" and kinds["inlet_1"] == "patch" and kinds["step"] == "wall",
          kinds)
    text = (case / "constant/polyMesh/boundary").read_text()
    check("the condition is said as physicalType",
          all(f"physicalType    {word};" in text for word in ("inviscid-wall", "overset",
                                                               "inflow")), text)
    check("a controlDict that is there is kept", "// mine" in own.read_text())

    made = run("mesh", cube, "-o", f"{case}/", "-o", folder / "channel" / "x.foam", *USUAL)
    check_exit("one case twice", made, 2, "twice")
    zones = case / "constant/polyMesh/cellZones"
    zones.write_text("mine")
    before = (case / "constant/polyMesh/points").read_bytes()
    made = run("mesh", cube, "-o", f"{case}/", *USUAL)
    check_exit("zones of another mesh are not destroyed", made, 3, "cellZones")
    check("nor is the mesh", zones.exists()
          and (case / "constant/polyMesh/points").read_bytes() == before)
    made = run("mesh", cube, "-o", cube, "--format", "openfoam", *USUAL)
    check_exit("a file in the place of the case", made, 3, "cube.cgns")
    made = run("mesh", cube, "-o", f"{folder}/none/case/", *USUAL)
    check_exit("a case in a folder that is missing", made, 3, "none")
    left = [name for name in listing(folder) if ".part" in name or ".old" in name]
    check("nothing temporary is left", not left, left)

finish()
