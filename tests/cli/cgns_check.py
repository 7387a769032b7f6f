"""Every example in CGNS, to the satisfaction of cgnscheck: no error, no warning; and conditions
and names as they are asked for."""

import json
import re
import shutil
import subprocess
from pathlib import Path

from _command import DATA, check, check_exit, finish, run, scratch, skip

if shutil.which("cgnscheck") is None:
    skip("there is no cgnscheck (Debian package cgns-convert)")

CURVES = {"airfoil", "circle"}
PLANE = "WARNING:coordinate range is 0"  # of a plane surface: true, and no fault


def complaints(file):
    said = subprocess.run(["cgnscheck", "-v", file], capture_output=True, text=True).stdout
    finished = ["did not finish"] if "checking complete" not in said else []
    return finished + re.findall(r"^.*(?:ERROR|WARNING).*$", said, re.M)


def facts(file):
    said = run("info", "--json", file)
    check_exit(f"info {Path(file).name}", said, 0)
    return json.loads(said.stdout)


def conditions(file):
    return {family["name"]: family["type"] for family in facts(file)["families"]}


def mesh(surface, out, *options):
    made = run("mesh", surface, "--layers", 4, "--repair", "off", "-o", out, "--quiet", *options)
    check(f"mesh {Path(surface).name} {' '.join(map(str, options))}: blocks are written",
          made.returncode in (0, 1) and Path(out).exists(), made.stderr)
    said = complaints(out)
    check(f"{Path(out).name}: cgnscheck finds nothing", not said, "\n".join(said[:20]))


with scratch() as folder:
    names = [line.split()[0] for line in run("example").stdout.splitlines()]
    check("there are examples", len(names) > 10, names)
    for name in names:
        surface = Path(folder) / (f"{name}.xyz" if name in CURVES else f"{name}.cgns")
        check_exit(f"example {name}", run("example", name, "-o", surface), 0)
        if name not in CURVES:
            said = [line for line in complaints(surface) if line != PLANE]
            check(f"{surface.name}: cgnscheck finds nothing", not said, "\n".join(said[:20]))
        mesh(surface, Path(folder) / f"{name}-mesh.cgns", "--distance", 0.05)
    mesh(Path(folder) / "cube.cgns", Path(folder) / "fans.cgns", "--distance", 0.2, "--fans", 4)

    out = Path(folder) / "overset.cgns"
    mesh(Path(folder) / "channel.cgns", out, "--distance", 0.1, "--outer", "overset", "--bc",
         "step:BCWallViscousIsothermal", "--plane", "x=0:inlet", "--plane", "x=4:outlet")
    found = conditions(out)
    meant = {"step": "BCWallViscousIsothermal", "upper": "BCWallViscous", "outer": "UserDefined",
             "inlet": "BCInflow", "outlet": "BCOutflow", "symmetry": "BCSymmetryPlane",
             "symmetry 2": "BCSymmetryPlane"}
    check("conditions are those that are asked for, or that names mean",
          {name: found.get(name) for name in meant} == meant, found)
    config = Path(folder) / "run.toml"
    config.write_text('outer = "overset"\nbc = ["upper:inviscid-wall", "inlet:farfield"]\n'
                      'plane = ["x=0:inlet"]\n')
    mesh(Path(folder) / "channel.cgns", out, "--distance", 0.1, "--config", config)
    found = conditions(out)
    check("a configuration file sets them too",
          found.get("upper") == "BCWallInviscid" and found.get("inlet") == "BCFarfield"
          and found.get("outer") == "UserDefined", found)

    def refused(claim, *options, parts):
        said = run("mesh", Path(folder) / "channel.cgns", "--distance", 0.1, "--layers", 4,
                   "-o", Path(folder) / "no.cgns", *options)
        check_exit(claim, said, 2, *parts)

    refused("a name that nothing has", "--bc", "roof:wall", parts=("roof", "upper", "symmetry 2"))
    refused("a kind that is none", "--bc", "upper:sticky", parts=("sticky", "inviscid-wall"))
    refused("no kind", "--bc", "upper", parts=("--bc upper", "NAME:KIND"))
    refused("a name twice", "--bc", "upper:wall", "--bc", "upper:inflow", parts=("upper", "twice"))
    refused("an outer that is none", "--outer", "wall", parts=("farfield",))
    check("refused runs leave nothing", not (Path(folder) / "no.cgns").exists())

    bytes_of = (Path(folder) / "cube.cgns").read_bytes()
    broken = Path(folder) / "broken.cgns"
    broken.write_bytes(bytes_of[:len(bytes_of) // 2])
    check_exit("a file that is cut", run("info", broken), 3, "cut short", str(len(bytes_of)))
    broken.write_bytes(bytes_of[:8] + b"\x09" + bytes_of[9:])
    check_exit("a file of a newer HDF5", run("info", broken), 3, "newer HDF5", "h5repack")
    broken.write_bytes(b"hello, world" * 100)
    check_exit("a file of another kind", run("info", broken), 3, "neither HDF5 nor ADF")

    said = []
    for at in range(1, 24):
        place = at * len(bytes_of) // 24
        broken.write_bytes(bytes_of[:place] + b"\xff" * 8 + bytes_of[place + 8:])
        made = run("info", broken)
        said.append((made.returncode, made.stderr))
    check("damaged files are read, or refused in one line",
          all(code in (0, 2, 3) and text.count("\n") <= 1 for code, text in said)
          and any(code == 3 for code, _ in said), said)

    if not DATA.exists():
        print("no shared data: real files are left out")
        finish()
    wall = DATA / "cgns" / "717_wl_L2.cgns"
    found = facts(wall)
    cells = sum((z["ni"] - 1) * (z["nj"] - 1) * (z["nk"] - 1) for z in found["zones"])
    check("717_wl_L2 is an ADF file of 15,120 cells",
          found["container"] == "ADF" and cells == 15120, (found["container"], cells))
    mesh(wall, Path(folder) / "717.cgns", "--distance", 0.2)
    check("its walls keep their family", conditions(Path(folder) / "717.cgns").get("wall")
          == "BCWallViscous", conditions(Path(folder) / "717.cgns"))
    mesh(DATA / "cgns" / "pyhyp_corner.cgns", Path(folder) / "corner.cgns", "--distance", 0.3)
    for name in ("m6_small", "bwb"):
        mesh(DATA / "plot3d" / f"{name}.fmt", Path(folder) / f"{name}.cgns", "--distance", 0.05,
             "--voxel", 0.02 if name == "m6_small" else 0.05)

finish()
