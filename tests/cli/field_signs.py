"""Inside and outside of `field`, and the faces that it names, judged by mathematics on the reports,
the log, and what vdb_print says."""

import json
import math
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

from _command import COMMAND, check, check_exit, finish, run, scratch, skip, wait_for_handler


def box(low, high):
    """Corners and outward triangles."""
    corners = [[(low, high)[n >> 2 & 1][0], (low, high)[n >> 1 & 1][1], (low, high)[n & 1][2]]
               for n in range(8)]
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


def obj(file, *parts):
    with file.open("w") as out:
        first = 1
        for corners, faces in parts:
            out.writelines("v {:.17g} {:.17g} {:.17g}\n".format(*p) for p in corners)
            out.writelines("f " + " ".join(str(n + first) for n in f) + "\n" for f in faces)
            first += len(corners)
    return file


def figures(file, grid="phi"):
    """What vdb_print says of a grid."""
    said = subprocess.run(["vdb_print", "-l", file], capture_output=True, text=True).stdout
    part = [p for p in said.split("\nName: ")[1:] if p.split("\n")[0].strip() == grid][0]

    def number(pattern):
        found = re.search(pattern, part)
        return float(found.group(1).replace(",", "")) if found else None

    return {"class": (re.search(r"^  class: (.*)$", part, re.M) or [None, "unknown"])[1],
            "voxels": number(r"Number of active voxels: +([\d,]+)"),
            "least": number(r"Min value: ([-\d.e+]+)\n"),
            "most": number(r"Max value: ([-\d.e+]+)\n")}


def field(claim, surface, voxel, distance, *options, said=(), silent=(), code=0):
    out, report = surface.with_suffix(".vdb"), surface.with_suffix(".json")
    done = run("field", surface, "--voxel", voxel, "--distance", distance, "-o", out, "--report",
               report, *options)
    check_exit(f"{claim}: field {' '.join(map(str, options))}", done, code, *said)
    for words in silent:
        check(f"{claim}: nothing of '{words}'", words not in done.stderr, done.stderr)
    return out, json.loads(report.read_text()) if code == 0 else done.stderr


def judge_overlaps(folder):
    """Two cubes that share a corner, and one in another: on both sides as on one."""
    unit = box([0, 0, 0], [1, 1, 1])
    cases = {"overlap": (box([0.6, 0.6, 0.6], [1.6, 1.6, 1.6]), "closed parts overlap"),
             "nested": (box([0.3, 0.3, 0.3], [0.7, 0.7, 0.7]), "closed parts overlap")}
    for name, (other, words) in cases.items():
        surface = obj(folder / f"{name}.obj", unit, other)
        for side in ("along", "both"):
            _, told = field(f"{name}, {side}", surface, 0.05, 0.2, "--side", side,
                            said=[words, "--sign winding"])
            check(f"{name}, {side}: 24 triangles of 16 nodes are counted once",
                  told["surface"]["faces"] == 24 and told["surface"]["nodes"] == 16,
                  told["surface"])
    thin = obj(folder / "thin.obj", box([0, 0, 0], [1, 1, 0.02]))
    for side in ("along", "both"):
        field(f"thin, {side}", thin, 0.05, 0.2, "--side", side, said=["thinner than two voxels"])


def judge_crossing(folder):
    """A closed tube whose second half is pushed through its first: one part, through itself."""
    ring = [[0, 0], [1, 0], [1, 1], [0, 1]]
    way = [(0, 0, 0), (3, 0, 0), (3, 3, 0), (1, 3, 0), (1, -2, 0.3)]
    corners, faces = [], []
    for n, place in enumerate(way):
        ahead = way[min(n + 1, len(way) - 1)]
        back = way[max(n - 1, 0)]
        along = [b - a for a, b in zip(back, ahead)]
        size = math.hypot(along[0], along[1])
        across = [-along[1] / size, along[0] / size]
        for u, v in ring:
            corners.append([place[0] + 0.8 * (u - 0.5) * across[0],
                            place[1] + 0.8 * (u - 0.5) * across[1], place[2] + 0.8 * (v - 0.5)])
    for n in range(len(way) - 1):
        for k in range(4):
            a, b = 4 * n + k, 4 * n + (k + 1) % 4
            faces += [[a, b, b + 4], [a, b + 4, a + 4]]
    last = 4 * (len(way) - 1)
    faces += [[2, 1, 0], [3, 2, 0], [last, last + 1, last + 2], [last, last + 2, last + 3]]
    surface = obj(folder / "crossed.obj", (corners, faces))
    field("tube through itself", surface, 0.1, 0.3, said=["goes through itself", "--sign winding"])
    apart = obj(folder / "straight.obj", (corners[:16], faces[:24] + [
        [2, 1, 0], [3, 2, 0], [12, 13, 14], [12, 14, 15]]))
    field("tube that does not", apart, 0.1, 0.3, silent=["goes through itself"])


def judge_gap(folder):
    """Two cubes with a gap of two voxels and a half, of a 200th of their edges."""
    gap = obj(folder / "gap.obj", box([0.013, 0.027, 0.011], [1.013, 1.027, 1.011]),
              box([1.018, 0.027, 0.011], [2.018, 1.027, 1.011]))
    _, told = field("gap", gap, 0.002, 0.004, silent=["points welded"])
    check("gap: its two bodies stay two", told["surface"]["nodes"] == 16, told["surface"])
    # Cracks are closed as before: a cube whose top is off by 1e-4.
    corners, faces = box([0, 0, 0], [1, 1, 1])
    top = [f for f in faces if all(corners[n][2] == 1 for n in f)]
    rest = [f for f in faces if f not in top]
    lifted = [[x, y, z + (1e-4 if z == 1 else 0)] for x, y, z in corners]
    crack = obj(folder / "crack.obj", (corners, rest), (lifted, top))
    _, told = field("crack", crack, 0.05, 0.2, said=["points welded"])
    check("crack: is closed", told["surface"]["closed"], told["surface"])
    wide = obj(folder / "wide.obj", (corners, rest),
               ([[x, y, z + (0.008 if z == 1 else 0)] for x, y, z in corners], top))
    field("wide crack", wide, 0.005, 0.01, said=["welding closed gaps as wide as 0.008",
                                                "--weld 0"])


def judge_curves(folder):
    """A circle of radius 1: signed in its slice, as closed curves of any kind are."""
    count = 400
    places = [(math.cos(2 * math.pi * n / count), math.sin(2 * math.pi * n / count))
              for n in range(count)]
    circle = folder / "circle.obj"
    circle.write_text("".join(f"v {x:.17g} {y:.17g} 0\n" for x, y in places)
                      + "l " + " ".join(str(n + 1) for n in range(count)) + " 1\n")
    voxel, distance = 0.02, 0.2
    reach = distance + 4 * voxel
    for options in (["--side", "both"], ["--side", "both", "--sign", "closed"]):
        out, told = field("circle", circle, voxel, distance, *options, silent=["is open"])
        phi = figures(out)
        check("circle: a level set, and the report says so", phi["class"] == "level set"
              and told["surface"]["closed"] and told["field"].get("sign", "normals") == "normals",
              (phi, told["field"]))
        inside = -reach < phi["least"] < voxel - reach
        check(f"circle: phi falls to {-reach:g} and rises to {reach:g}", inside
              and reach - voxel < phi["most"] < 1.001 * reach, phi)
        area = math.pi * ((1 + reach) ** 2 - (1 - reach) ** 2) / voxel**2
        check(f"circle: about {area:.0f} voxels, in one slice",
              abs(phi["voxels"] / area - 1) < 0.03, phi)
    half = folder / "arc.obj"
    half.write_text("".join(f"v {x:.17g} {y:.17g} 0\n" for x, y in places[:200])
                    + "l " + " ".join(str(n + 1) for n in range(200)) + "\n")
    field("arc", half, voxel, distance, said=["sign: none, for the curve is open"])
    field("arc", half, voxel, distance, "--sign", "closed", code=2, said=["2 free ends"])


def judge_words(folder):
    """What an open surface, a flat one and the other side of a body get is said."""
    corners, faces = box([0, 0, 0], [1, 1, 1])
    plate = obj(folder / "plate.obj", (corners[:4], [[0, 1, 3], [0, 3, 2]]))
    field("plate", plate, 0.05, 0.2, said=["sign: none", "--side both has the other"])
    field("plate", plate, 0.05, 0.2, "--side", "both", silent=["--side both has the other"])
    cube = obj(folder / "cube.obj", (corners, faces))
    out, _ = field("cube", cube, 0.05, 0.2, "--side", "against", said=["phi is positive behind"])
    phi = figures(out)
    check("cube, against: positive inside, and no level set", phi["class"] == "unknown"
          and phi["most"] > 0.2, phi)
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    flat = obj(folder / "flat.obj", (square, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))
    field("flat tetrahedron", flat, 0.05, 0.2, said=["without an inside", "--sign unsigned"])


def judge_limits(folder):
    """Refused before there is a band, and by --dry-run."""
    cube = obj(folder / "large.obj", box([0, 0, 0], [1e6, 1e6, 1e6]))
    small = obj(folder / "small.obj", box([0, 0, 0], [1e-4, 1e-4, 1e-4]))
    for more in ([], ["--dry-run"]):
        for name, surface, options, words in (
                ("half", cube, [2e4, 7e4, "--half"], "--half"),
                ("voxel", small, [1e-5, 2e-5], "OpenVDB holds no voxels below")):
            done = run("field", surface, "--voxel", options[0], "--distance", options[1],
                       "-o", folder / "no.vdb", *options[2:], *more)
            check_exit(f"limit of {name} {' '.join(more)}", done, 3, words)
            check(f"limit of {name}: no band was made", "rasterize  " not in done.stderr,
                  done.stderr)
        done = run("mesh", small, "--voxel", 1e-5, "--distance", 2e-5, "--first-cell", 4e-6,
                   "--layers", 4, "-o", folder / "no.vtu", "--vdb", folder / "no.vdb", *more)
        check_exit(f"limit of a mesh's voxel {' '.join(more)}", done, 3, "OpenVDB holds no voxels")
        check("limit of a mesh's voxel: no band was made", "rasterize  " not in done.stderr,
              done.stderr)


def judge_interrupt(folder):
    """While grids are made, whose queries take longest."""
    corners, faces = box([0.01, 0.02, 0.03], [1.01, 1.02, 1.03])
    cube = obj(folder / "slow.obj", (corners, faces))
    out = folder / "slow.vdb"
    process = subprocess.Popen(
        [COMMAND, "field", cube, "--voxel", "0.006", "--distance", "0.3", "--side", "both",
         "--grids", "phi,feature", "-o", out], stderr=subprocess.PIPE, text=True)
    wait_for_handler(process, signal.SIGINT)
    for line in process.stderr:
        if line.startswith("sweep"):
            break
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    start = time.monotonic()
    process.stderr.read()
    code = process.wait()
    check("Ctrl-C while grids are written: exit 130", code == 130, code)
    check("Ctrl-C while grids are written: ends within 3 s", time.monotonic() - start < 3)
    check("Ctrl-C while grids are written: no file is left",
          not list(folder.glob("slow.vdb*")), list(folder.glob("slow.vdb*")))


def judge_features(folder):
    """A long bar: its ends and sides by their numbers in the file, whatever they are made of."""
    corners, _ = box([0, 0, 0], [1, 1, 1])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    for name, split in (("quads", 0), ("mixed", 3), ("triangles", 6)):
        faces = [t for a, b, c, d in quads[:split] for t in ([a, b, c], [a, c, d])] + quads[split:]
        surface = obj(folder / f"{name}.obj", (corners, [[0, 0, 1]] + faces))
        out, _ = field(name, surface, 0.05, 0.2, "--grids", "phi,feature")
        feature = figures(out, "feature")
        check(f"{name}: features are 1 to {len(faces)}, behind a face of no area",
              feature["least"] == 1 and feature["most"] == len(faces), feature)


if not shutil.which("vdb_print"):
    skip("vdb_print is not installed")

with scratch() as folder:
    folder = Path(folder)
    for judge in (judge_features, judge_overlaps, judge_crossing, judge_gap, judge_curves,
                  judge_words, judge_limits, judge_interrupt):
        judge(folder)
finish()
