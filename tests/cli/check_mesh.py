"""check: quality and connectivity of meshes, ours and others', as table, JSON and exit code."""

import json
import re
import struct
from pathlib import Path

from _command import DATA, check, check_exit, example, finish, run, scratch


def facts(file, *options):
    said = run("check", file, "--json", *options)
    try:
        return said.returncode, json.loads(said.stdout)
    except json.JSONDecodeError:
        return said.returncode, {"said": said.stderr}


def sound(claim, file, cells=None, connected=True):
    code, found = facts(file)
    check(f"{claim} is sound", code == 0 and found.get("sound") is True
          and found["fault_count"] == 0 and found["connectivity"]["known"] is connected
          and found["quality"]["nonpositive_cells"] == 0
          and (cells is None or found["quality"]["cells"] == cells),
          json.dumps(found)[:2000])


def kinds(found):
    return [fault["kind"] for fault in found.get("faults", [])]


def put(file, block, point, component, value):
    """One coordinate of a PLOT3D file of ours: Fortran records, double, native byte order."""
    data = bytearray(file.read_bytes())
    blocks = struct.unpack_from("=i", data, 4)[0]
    sizes = [struct.unpack_from("=3i", data, 16 + 12 * b) for b in range(blocks)]
    at = 12 + 8 + 12 * blocks
    for ni, nj, nk in sizes[:block]:
        at += 8 + 24 * ni * nj * nk
    ni, nj, nk = sizes[block]
    i, j, k = point
    index = component * ni * nj * nk + (k * nj + j) * ni + i
    struct.pack_into("=d", data, at + 4 + 8 * index, value)
    file.write_bytes(data)


MESH = ("--distance", 0.2, "--layers", 6)
with scratch() as folder:
    folder = Path(folder)
    surfaces = [line.split()[0] for line in run("example").stdout.splitlines()]
    surfaces = [name for name in surfaces if name and name != "fuselage"]
    for name in surfaces:
        wall = example(folder, name, "--points", 9)
        flat = name in ("airfoil", "circle")
        outputs = ["-o", folder / "m.cgns", "-o", folder / "m.xyz"]
        outputs += [] if flat else ["-o", folder / "m.nmf"]
        made = run("mesh", wall, *MESH, *outputs, "--quiet")
        if made.returncode != 0:
            check(f"{name} can be meshed", made.returncode == 1, made.stderr)
            continue
        sound(f"{name} as CGNS", folder / "m.cgns")
        sound(f"{name} as PLOT3D{'' if flat else ' with its map'}", folder / "m.xyz",
              connected=not flat)
        (folder / "m.nmf").unlink(missing_ok=True)

    cube = example(folder, "cube", "--points", 5)
    grid, names = folder / "cube.xyz", folder / "cube.nmf"
    made = run("mesh", cube, "--distance", 0.2, "--layers", 4, "-o", folder / "box.xyz",
               "-o", folder / "box.nmf", "-o", folder / "box.fmt")
    check_exit("the cube's mesh with its map", made, 0)
    grid, names = folder / "box.xyz", folder / "box.nmf"
    sound("the cube", grid, cells=6 * 4 * 4 * 4)
    sound("as text, with the same map", folder / "box.fmt", cells=6 * 4 * 4 * 4)
    whole, lines = grid.read_bytes(), names.read_text().splitlines(keepends=True)

    table = run("check", grid)
    check_exit("as a table", table, 0)
    check("the table has zones, interfaces and no fault",
          all(part in table.stdout for part in
              ("6 zones", "384 cells", "block 6", "12 interfaces", "faults     none")),
          table.stdout)
    quiet = run("check", grid, "--quiet", "--report", folder / "r.json")
    check("--quiet says nothing, --report writes", quiet.returncode == 0 and not quiet.stdout
          and not quiet.stderr and json.loads((folder / "r.json").read_text())["sound"],
          quiet.stderr)

    put(grid, 0, (0, 2, 2), 0, 9.0)
    code, found = facts(grid)
    check("a point that is moved: cells not positive, and a mismatch that names it",
          code == 1 and kinds(found) == ["mismatch"] and found["faults"][0]["points"] == 1
          and found["quality"]["nonpositive_cells"] > 0 and found["cells"][0]["zone"] == "block 1"
          and not found["sound"], json.dumps(found)[:2000])
    grid.write_bytes(whole)

    def with_lines(keep):
        names.write_text("".join(line for n, line in enumerate(lines) if keep(n, line)))
        return facts(grid)

    first = next(n for n, line in enumerate(lines) if line.startswith("ONE_TO_ONE"))
    wall = next(n for n, line in enumerate(lines) if line.startswith("WALL"))
    code, found = with_lines(lambda n, _: n != first)
    check("an interface that is missing: a gap on both sides",
          code == 1 and kinds(found) == ["gap", "gap"] and found["faults"][0]["faces"] == 16,
          found)
    code, found = with_lines(lambda n, _: n != wall)
    check("a wall that is missing: faces that nothing covers",
          code == 1 and kinds(found) == ["uncovered"] and found["faults"][0]["faces"] == 16, found)
    names.write_text("".join(lines) + lines[wall])
    code, found = facts(grid)
    check("a wall that stands twice: faces covered twice", code == 1
          and kinds(found) == ["doubly-covered"], found)
    swapped = lines[first].replace("FALSE", "x").replace("TRUE", "FALSE").replace("x", "TRUE")
    names.write_text("".join(lines[:first] + [swapped] + lines[first + 1:]))
    code, found = facts(grid)
    check("an interface turned round: its points are apart", code == 1
          and kinds(found) == ["mismatch"], found)
    names.write_text(re.sub(r"WALL +1", "WALL 9", "".join(lines)))
    check_exit("a map that cannot be", run("check", grid), 3, "box.nmf, line", "block = 9")
    names.unlink()
    sound("without a map, the cells", grid, connected=False)
    names.write_text("".join(lines))
    other = folder / "other.nmf"
    other.write_text("1\n1 2 2 2\n")
    check_exit("a map of another mesh", run("check", grid, "--nmf", other), 3, "other.nmf",
               "blocks")
    check_exit("a map alone", run("check", names), 2, "--nmf")
    check_exit("a surface", run("check", cube), 3, "surface")
    check_exit("no file", run("check", folder / "none.xyz"), 3, "none.xyz")
    check_exit("a map for CGNS", run("check", folder / "m.cgns", "--nmf", names), 2, "--nmf")
    check_exit("no threads", run("check", grid, "--threads", 0), 2, "--threads")

    one, many = (facts(folder / "m.cgns", "--threads", n)[1] for n in (1, 4))
    one.pop("seconds"), many.pop("seconds")
    check("one thread finds what four find", one == many and "quality" in one)

    shown = run("info", names, "--json")
    check_exit("info of a map", shown, 0)
    found = json.loads(shown.stdout or "{}")
    check("it counts blocks, interfaces and types", len(found.get("blocks", [])) == 6
          and found.get("interfaces") == 12 and found.get("types", {}).get("WALL") == 6, found)

    if not DATA.exists():
        print("no shared data: real files are left out")
        finish()
    sound("717_wl_L2, 15,120 cells,", DATA / "cgns" / "717_wl_L2.cgns", cells=15120)
finish()
