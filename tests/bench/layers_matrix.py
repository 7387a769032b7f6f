#!/usr/bin/python3
"""Meshes a matrix of surfaces, resolutions and voxel sizes; the report and VTK judge every cell.

    layers_matrix.py [--only SUBSTRING] [--quick] [--json FILE] [--timeout S] [--keep DIR]

64 layers, first cell 1e-4 of the size, distance half the size, unless CASES says otherwise.
Prints a line a run and, for each that failed, the commands that make it again. Exits 1 if a run has
a non-positive cell by either judge, stops with an error, or takes longer than the timeout.

Needs the command (VDB_OFFSET), python3-vtk9, and for the cases of files the shared data
(VDB_OFFSET_SHARED_DATA); a case whose file is missing is skipped, and said to be.
"""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from _command import COMMAND, DATA  # noqa: E402
from _vtk import blocks, corner_jacobians, np, scaled_jacobians  # noqa: E402

VOXELS = {"default": 1, "half": 0.5, "double": 2}
POINTS = (17, 9, 33)  # the middle one first: it finds most, soonest
OUR_EXITS = (0, 1)  # done, and done with a cell that is not positive


@dataclass
class Case:
    """One surface with one set of layers."""

    name: str
    surface: str  # of `example` with its options, or a file of the shared data
    distance: float = 0.5
    first: float = 1e-4
    layers: int = 64
    points: tuple = POINTS
    boundary: str = ""  # of `example`: what free edges end on

    def is_file(self):
        return "/" in self.surface


CASES = [
    Case("cube", "cube"),
    Case("l-bar 0.1", "l-bar", 0.1),
    Case("l-bar 0.3", "l-bar", 0.3),
    Case("l-bar 0.5", "l-bar", 0.5),
    Case("u-slot", "u-slot"),
    Case("wedge 120", "wedge --angle 120"),
    Case("wedge 90", "wedge --angle 90"),
    Case("wedge 60", "wedge --angle 60"),
    Case("wedge 30", "wedge --angle 30"),
    Case("wedge 10", "wedge --angle 10"),
    Case("star", "star"),
    Case("sphere", "sphere", 1.0, 2e-4),
    Case("torus", "torus", 1.4, 2.8e-4),
    Case("sphere-pair 0.4", "sphere-pair --gap 0.4", 1.0, 2e-4),
    Case("sphere-pair 0.05", "sphere-pair --gap 0.05", 1.0, 2e-4),
    Case("naca0012-wing", "naca0012-wing"),
    Case("quarter-cylinder", "quarter-cylinder"),
    Case("wing-on-cylinder", "wing-on-cylinder", boundary="fuselage"),
    Case("channel", "channel"),
    Case("uneven_sphere", "plot3d/uneven_sphere.fmt", 0.5, 1e-4),
    Case("corner", "cgns/pyhyp_corner.cgns"),
    Case("draft-tube 0.06", "draft-tube", 0.06, layers=24),
    Case("draft-tube closed 0.06", "draft-tube --closed", 0.06, layers=24),
    Case("bwb", "plot3d/bwb.fmt", 2, layers=48),
    Case("m6_small", "plot3d/m6_small.fmt", 0.1, 1e-5, layers=48),
    Case("draft-tube 0.5", "draft-tube", 0.5),
    Case("draft-tube closed 0.5", "draft-tube --closed", 0.5),
]


@dataclass
class Run:
    """One cell of the matrix, in the order in which it is worth having."""

    case: Case
    points: int  # 0: a file
    voxel: str

    def label(self):
        return f"{self.case.name} {self.points or 'file'} {self.voxel}"


def plan(only, quick):
    runs = []
    for voxel in ["default"] if quick else VOXELS:
        for at in range(1 if quick else len(POINTS)):
            for case in CASES:
                points = sorted(case.points) if quick else case.points
                if case.is_file() and at == 0:
                    runs.append(Run(case, 0, voxel))
                if not case.is_file() and at < len(points):
                    runs.append(Run(case, points[at], voxel))
    return [run for run in runs if only in run.label()]


class Bench:
    """Runs the command in a folder and remembers its commands."""

    def __init__(self, folder, timeout, threads):
        self.folder, self.timeout, self.threads = Path(folder), timeout, threads
        self.commands = []

    def call(self, *arguments):
        words = [COMMAND, *map(str, arguments)]
        self.commands.append(shlex.join(words))
        return subprocess.run(words, capture_output=True, text=True, errors="replace",
                              timeout=self.timeout)

    def example(self, surface, points):
        words = surface.split()
        file = self.folder / f"{'-'.join(w.strip('-') for w in words)}-{points}.xyz"
        made = self.call("example", *words, "--points", points, "-o", file)
        if made.returncode != 0:
            raise RuntimeError(made.stderr.strip())
        return file

    def surface_options(self, run):
        case = run.case
        file = DATA / case.surface
        if not case.is_file():
            file = self.example(case.surface, run.points)
        options = [file, "--distance", case.distance, "--layers", case.layers,
                   "--first-cell", case.first]
        if case.boundary:
            options += ["--boundary", self.example(case.boundary, run.points)]
        return options

    def voxel_options(self, options, voxel):
        if voxel == "default":
            return []
        planned = self.call("mesh", *options, "--dry-run")
        del self.commands[-1]  # nobody needs it to see the failure again
        found = re.search(r"^voxel\s+(\S+)", planned.stdout, re.M)
        if not found:
            raise RuntimeError(planned.stderr.strip())
        return ["--voxel", f"{float(found[1]) * VOXELS[voxel]:.6g}"]

    def mesh(self, run):
        """The row of a run: what the command, its report and VTK say."""
        self.commands = []
        options = self.surface_options(run)
        options += self.voxel_options(options, run.voxel)
        vtm, report = self.folder / "mesh.vtm", self.folder / "mesh.json"
        report.unlink(missing_ok=True)
        done = self.call("mesh", *options, "-o", vtm, "--report", report, "--threads",
                         self.threads)
        row = {"exit": done.returncode}
        if done.returncode not in OUR_EXITS:
            return {**row, "error": (done.stderr.strip().splitlines() or [""])[-1]}
        return {**row, **of_report(json.loads(report.read_text())), **by_vtk(vtm)}


def of_report(report):
    quality, first = report["quality"], report["quality"]["first_cell"]
    parts = report["coverage"]
    return {
        "cells": report["blocks"]["cells"],
        "bad": quality["nonpositive_cells"],
        "sj": quality["min_scaled_jacobian"],
        "first": [first[key] / first["requested"] for key in ("min", "median", "max")],
        "coverage_min": min(part["min"] for part in parts),
        "coverage_mean": sum(part["mean"] for part in parts) / len(parts),
        "voxel_size": report["field"]["voxel_size"],
        "seconds_blocks": report["time"]["blocks"],
        "seconds": report["time"]["total"],
    }


def by_vtk(vtm):
    """Cells that VTK finds folded, by Verdict's scaled Jacobian or by a corner's determinant."""
    least, bad, cells = 1.0, 0, 0
    for grid in blocks(vtm):
        if 1 in grid.GetDimensions():
            continue  # a face of a block, under its boundary's name
        quality, corners = scaled_jacobians(grid), corner_jacobians(grid)
        least = min(least, float(quality.min()))
        bad += int(np.count_nonzero(~((quality > 0) & (corners > 0))))
        cells += len(quality)
    return {"vtk_cells": cells, "vtk_bad": bad, "vtk_sj": least}


def has_failed(row):
    if row["exit"] not in OUR_EXITS:
        return True
    return row["bad"] > 0 or row["vtk_bad"] > 0 or row["exit"] != 0 or (
        row["cells"] != row["vtk_cells"])


HEAD = (f"{'name':<22} {'points':>6} {'voxel':>8} {'cells':>8} {'bad':>6} {'VTK':>6} {'SJ':>7} "
        f"{'VTK':>7} {'first cell / asked':>20} {'cover min mean':>14} {'blocks s':>8} exit")


def line(row):
    head = f"{row['name']:<22} {row['points'] or 'file':>6} {row['voxel']:>8} "
    if "bad" not in row:
        return head + f"exit {row['exit']}: {row['error']}"
    first = " ".join(f"{x:6.3f}" for x in row["first"])
    return head + (f"{row['cells']:8d} {row['bad']:6d} {row['vtk_bad']:6d} {row['sj']:7.4f} "
                   f"{row['vtk_sj']:7.4f} {first} {row['coverage_min']:7.4f} "
                   f"{row['coverage_mean']:6.4f} {row['seconds_blocks']:8.1f} {row['exit']:4d}")


def one(bench, run):
    row = {"name": run.case.name, "points": run.points, "voxel": run.voxel}
    try:
        row.update(bench.mesh(run))
    except subprocess.TimeoutExpired:
        row.update(exit=-1, error=f"longer than {bench.timeout} s")
    except RuntimeError as error:
        row.update(exit=-1, error=str(error))
    row["failed"] = has_failed(row)
    row["commands"] = bench.commands if row["failed"] else []
    return row


def missing(case):
    return case.is_file() and not (DATA / case.surface).is_file()


def sweep(bench, options):
    rows = []
    for case in {run.case.name: run.case for run in plan(options.only, options.quick)}.values():
        if missing(case):
            print(f"skipped: {case.name}: {DATA / case.surface} is not here")
    print(HEAD, flush=True)
    for run in plan(options.only, options.quick):
        if missing(run.case):
            continue
        row = one(bench, run)
        rows.append(row)
        print(line(row), flush=True)
        for command in row["commands"]:
            print("    " + command, flush=True)
        if options.json:
            options.json.write_text(json.dumps(rows, indent=1))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="runs whose 'name points voxel' contains this")
    parser.add_argument("--quick", action="store_true", help="coarsest surface, default voxel")
    parser.add_argument("--json", type=Path, help="all rows, rewritten after each run")
    parser.add_argument("--timeout", type=float, default=1200, help="seconds a run")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder of surfaces and the last mesh")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="vdb-offset-matrix-") as scratch:
        folder = options.keep or Path(scratch)
        os.makedirs(folder, exist_ok=True)
        rows = sweep(Bench(folder, options.timeout, options.threads), options)
    failed = sum(row["failed"] for row in rows)
    print(f"{len(rows)} runs, {failed} failed, "
          f"{sum(row.get('cells', 0) for row in rows)} cells judged")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
