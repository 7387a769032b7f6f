"""The grids of `field`, as OpenVDB's own vdb_print reads them back; memory against the tree's."""

import json
import re
import shutil
import subprocess
from pathlib import Path

from _command import COMMAND, check, check_exit, example, finish, run, scratch, skip

TYPES = {"phi": "Tree_float_5_4_3", "normal": "Tree_vec3s_5_4_3", "feature": "Tree_int32_5_4_3"}
MARGIN = 4  # voxels by which the band reaches past the distance
VOXEL = 0.05
DISTANCE = 0.3


def number(text, pattern):
    found = re.search(pattern, text)
    return float(found.group(1).replace(",", "")) if found else None


def listed(file):
    """What `vdb_print -l` says of each grid, by name."""
    said = subprocess.run(["vdb_print", "-l", file], capture_output=True, text=True)
    check(f"{file.name}: vdb_print reads it", said.returncode == 0, said.stderr)
    grids = {}
    for part in said.stdout.split("\nName: ")[1:]:
        grids[part.split("\n")[0].strip()] = {
            "type": re.search(r"Type: (\S+)", part).group(1),
            "class": (re.search(r"^  class: (.*)$", part, re.M) or [None, "unknown"])[1],
            "half": "is_saved_as_half_float: true" in part,
            "voxels": number(part, r"Number of active voxels: +([\d,]+)"),
            "background": number(part, r"Background value: ([-\d.e+]+)\n"),
            "least": number(part, r"Min value: ([-\d.e+]+)\n"),
            "most": number(part, r"Max value: ([-\d.e+]+)\n"),
            "edge": number(part, r"voxel size: (\S+)"),
        }
    return grids


def field(folder, surface, name, *options):
    out, report = folder / f"{name}.vdb", folder / f"{name}.json"
    done = run("field", surface, "--distance", DISTANCE, "--voxel", VOXEL, "-o", out,
               "--report", report, *options)
    check_exit(f"{name}: field {' '.join(options)}", done, 0)
    return listed(out), json.loads(report.read_text())["field"]


def judge_grids(name, grids, wanted, told, half):
    check(f"{name}: grids {', '.join(wanted)}", sorted(grids) == sorted(wanted), sorted(grids))
    for grid, is_ in grids.items():
        check(f"{name}: {grid} is a {TYPES[grid]}", is_["type"] == TYPES[grid], is_)
        check(f"{name}: {grid} has the report's {told['active_voxels']} voxels",
              is_["voxels"] == told["active_voxels"], is_)
        check(f"{name}: {grid} has the voxel asked for", abs(is_["edge"] / VOXEL - 1) < 1e-3, is_)
        check(f"{name}: {grid} {'is' if half and grid != 'feature' else 'is not'} in 16 bits",
              is_["half"] == (half and grid != "feature"), is_)


def judge_phi(name, phi, kind, behind):
    """`behind`: how far the band reaches behind the wall, world units."""
    reach = DISTANCE + MARGIN * VOXEL
    check(f"{name}: phi is of class '{kind}'", phi["class"] == kind, phi)
    check(f"{name}: phi's background is its reach", abs(phi["background"] / reach - 1) < 1e-3, phi)
    check(f"{name}: phi rises to within a voxel of its reach",
          reach - VOXEL < phi["most"] <= 1.001 * reach, phi)
    check(f"{name}: phi falls to {-behind:g}, within a voxel",
          -1.001 * behind <= phi["least"] < VOXEL - behind, phi)


def voxels_between(inner, outer):
    """Of a shell about the lattice's zero, counted."""
    span = range(-int(outer / VOXEL) - 1, int(outer / VOXEL) + 2)
    squares = [(i * i + j * j) * VOXEL**2 for i in span for j in span]
    return sum(inner**2 <= s + (k * VOXEL) ** 2 <= outer**2 for s in squares for k in span)


def judge_sphere(folder):
    sphere = example(folder, "sphere")
    everything = list(TYPES)
    reach = DISTANCE + MARGIN * VOXEL
    for half in (False, True):
        more = ["--half"] if half else []
        name = "half" if half else "full"
        grids, told = field(folder, sphere, f"both-{name}", "--side", "both", "--grids",
                            "phi,normal,feature", *more)
        judge_grids(f"both-{name}", grids, everything, told, half)
        judge_phi(f"both-{name}", grids["phi"], "level set", reach)
        # The field is late by a third of a voxel at most, and the surface is of chords.
        least = voxels_between(1 - reach + VOXEL / 2, 1 + reach - VOXEL / 2)
        most = voxels_between(1 - reach - VOXEL / 2, 1 + reach + VOXEL / 2)
        check(f"both-{name}: as many voxels as the shell has, {least} to {most}",
              least <= told["active_voxels"] <= most, told)
    check("--half makes the file smaller", (folder / "both-half.vdb").stat().st_size
          < 0.8 * (folder / "both-full.vdb").stat().st_size)
    grids, told = field(folder, sphere, "along", "--grids", "phi,normal,feature")
    judge_grids("along", grids, everything, told, False)
    judge_phi("along", grids["phi"], "level set", 2.5 * VOXEL)
    quads = json.loads(run("info", sphere, "--json").stdout)["surface"]["faces"]
    feature = grids["feature"]
    check(f"along: features are the {quads} quads, and -1 is none", feature["least"] == 0
          and feature["most"] == quads - 1 and feature["background"] == -1, feature)
    for asked in ("phi", "normal", "feature"):
        grids, told = field(folder, sphere, asked, "--grids", asked)
        judge_grids(asked, grids, [asked], told, False)


def judge_open(folder):
    wing = example(folder, "naca0012-wing")
    grids, told = field(folder, wing, "open", "--side", "both", "--half")
    judge_grids("open", grids, ["phi"], told, True)
    judge_phi("open", grids["phi"], "unknown", 0)


def judge_memory(folder):
    """1e7 voxels: the promise is three times the float tree."""
    report = folder / "large.json"
    for name, surface, options in (("closed", "sphere", ["--voxel", 1 / 125, "--distance", 0.168]),
                                   ("open", "draft-tube", ["--voxel", 1 / 107, "--distance", 0.3])):
        file = example(folder, surface)
        done = run("field", file, "--side", "both", *options, "-o", folder / "large.vdb",
                   "--report", report)
        check_exit(f"{name} surface: a field of ten million voxels", done, 0)
        told = json.loads(report.read_text())
        peak, tree = told["run"]["peak_memory_bytes"], told["field"]["bytes"]
        check(f"{name}: {told['field']['active_voxels']} voxels are ten million",
              told["field"]["active_voxels"] > 9.5e6)
        check(f"{name}: peak memory is {peak / tree:.2f} of the tree, at most 3", peak <= 3 * tree)


if not shutil.which("vdb_print"):
    skip("vdb_print is not installed")

with scratch() as folder:
    folder = Path(folder)
    judge_sphere(folder)
    judge_open(folder)
    program = Path(shutil.which(COMMAND)).read_bytes()
    if b"__asan_init" in program or b"__tsan_init" in program:
        print("skipped: a sanitizer's memory is its own")
    else:
        judge_memory(folder)
finish()
