#!/usr/bin/python3
"""Open domains, gaps and two dimensions against exact formulas, one line a claim.

    open_domains.py [--only SUBSTRING] [--data FOLDER] [--keep DIR] [--threads N]

Meshes draft tubes, halves of spheres, walls oblique to a plane, facing walls and airfoils, reads
what was written (PLOT3D, .vts, the report) by code of its own, and prints of each claim the figure,
the bound and whether it holds; at the end "N passed, N failed". Exits 1 if any failed. Surfaces of
others are in FOLDER (VDB_OFFSET_SHARED_DATA); without them those claims are skipped, with a line.

Needs the command (VDB_OFFSET) and numpy. Takes about ten minutes.
"""

import argparse
import json
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from _command import DATA, run  # noqa: E402
from _grids import (Walls, bad_cells, bad_quads, columns, difference,  # noqa: E402
                    level_heights, polyline_gap, read_plot3d, read_plot3d_text, read_vtm,
                    write_plot3d)
from _shapes import (cube_sphere, extruded, halved, naca, regular_circle,  # noqa: E402
                     wall_at_plane)

SETTLED = ("--sweep-tolerance", 0, "--max-sweeps", 1000)


class Bench:
    """Runs the command in a folder, and counts claims."""

    def __init__(self, folder, data, threads):
        self.folder, self.data, self.threads = folder, data, threads
        self.passed = self.failed = 0

    def claim(self, text, holds, figure):
        self.passed += bool(holds)
        self.failed += not holds
        print(f"{'ok  ' if holds else 'FAIL'}  {text}: {figure}", flush=True)

    def below(self, text, figure, bound):
        self.claim(text, figure <= bound, f"{figure:.3g} (at most {bound:g})")

    def example(self, name, *options):
        file = self.folder / f"{name}.xyz"
        made = run("example", name, *options, "-o", file)
        if made.returncode != 0:
            sys.exit(f"example {name}: {made.stderr}")
        return file

    def mesh(self, surface, *options, to="mesh.xyz"):
        """Exit code, what was said, the blocks, the report; none of the last two if refused."""
        out, report = self.folder / to, self.folder / "report.json"
        report.unlink(missing_ok=True)
        done = run("mesh", surface, *options, "-o", out, "--report", report, "--threads",
                   self.threads, timeout=3600)
        if done.returncode not in (0, 1):
            return done.returncode, done.stderr, None, None
        blocks = read_vtm(out) if out.suffix == ".vtm" else read_plot3d(out)
        return done.returncode, done.stderr, blocks, json.loads(report.read_text())

    def meshed(self, text, surface, *options, to="mesh.xyz"):
        """Blocks and report; a claim that fails where it is refused."""
        code, said, blocks, report = self.mesh(surface, *options, to=to)
        if blocks is None:
            self.claim(f"{text}: meshed", False, f"exit {code}: {said.strip()[-300:]}")
        return blocks, report


def off_plane(lines, axis, value, size):
    """Of columns whose foot is on the plane x_axis = value, their number and how far any level is
    off it, over the size."""
    on = lines[np.abs(lines[:, 0, axis] - value) < 1e-9 * size]
    feet = np.unique(np.round(on[:, 0] / (1e-7 * size)), axis=0)
    return len(feet), np.abs(on[..., axis] - value).max(initial=0) / size


def draft_tube(bench):
    for points in (9, 17):
        surface = bench.example("draft-tube", "--points", points)
        wall = np.concatenate([b.reshape(-1, 3) for b in read_plot3d(surface)])
        size = np.ptp(wall, axis=0).max()
        for voxel in (0.01, 0.0075, 0.005):
            name = f"draft tube of {points} points, voxel {voxel}"
            blocks, _ = bench.meshed(name, surface, "--distance", 0.06, "--layers", 24,
                                     "--first-cell", 1e-4, "--voxel", voxel)
            if blocks is None:
                continue
            lines = columns(blocks)
            for end, axis, value in (("inlet", 2, -0.1), ("outlet", 0, 3.6)):
                count, off = off_plane(lines, axis, value, size)
                feet = wall[np.abs(wall[:, axis] - value) < 1e-9]
                rim = len(np.unique(np.round(feet, 7), axis=0))
                bench.claim(f"{name}: the {end}'s columns stand on all of its rim",
                            count == rim > 20, f"{count} of {rim}")
                bench.below(f"{name}: {end}, columns off its plane, sizes", off, 1e-12)
                beyond = (lines[..., axis] - value).max() / size
                bench.below(f"{name}: {end}, points beyond it, sizes", beyond, 1e-12)


def symmetry_planes(bench):
    for name, options in (("m6_small", ("--distance", 0.1, "--first-cell", 1e-5)),
                          ("bwb", ("--distance", 2, "--first-cell", 1e-4))):
        file = bench.data / "plot3d" / f"{name}.fmt"
        if not file.is_file():
            print(f"skipped: {file} is not here")
            continue
        wall = np.concatenate([b.reshape(-1, 3) for b in read_plot3d_text(file)])
        size = np.ptp(wall, axis=0).max()
        blocks, report = bench.meshed(name, file, "--layers", 48, *options)
        if blocks is None:
            continue
        lines = columns(blocks)
        count, off = off_plane(lines, 2, 0.0, size)
        rim = len(np.unique(np.round(wall[np.abs(wall[:, 2]) < 1e-9 * size] / (1e-7 * size)),
                            axis=0))
        bench.claim(f"{name}: columns stand on all of its root", count == rim > 20,
                    f"{count} of {rim}")
        bench.below(f"{name}: side faces off z = 0, sizes", off, 1e-12)
        bench.below(f"{name}: points beyond it, sizes", -lines[..., 2].min() / size, 1e-12)
        bad = report["quality"]["nonpositive_cells"]
        bench.claim(f"{name}: bad cells, the report's and by this script's corners",
                    bad == bad_cells(blocks) == 0, f"{bad}, {bad_cells(blocks)}")


def round_claims(bench, name, lines, voxel):
    """Of columns on a sphere or circle of radius 1, 16 layers from 0.01 to 1."""
    heights = level_heights(1.0, 0.01, 16)
    # Each node is convex, and so the nearest of the wall to its column.
    off = np.linalg.norm(lines - lines[:, :1], axis=-1) - heights
    bench.below(f"{name}: levels off their heights, radii", np.abs(off).max(), 1e-9)
    exact = lines[:, :1] * (1 + heights[:, None])
    bench.below(f"{name}: points off the line through the middle, voxels",
                np.linalg.norm(lines - exact, axis=-1).max() / voxel, 0.5)


def parts_of_a_sphere(bench):
    radius = 1.0
    whole_patches = cube_sphere(8, radius)
    parts = {"half": halved(whole_patches, 0)}
    parts["quarter"] = halved(parts["half"], 1)
    parts["eighth"] = halved(parts["quarter"], 2)
    for voxel in (0.125, 0.08):
        options = ("--distance", radius, "--layers", 16, "--first-cell", 0.01, "--voxel", voxel,
                   *SETTLED)
        whole, _ = bench.meshed("sphere", write_plot3d(bench.folder / "whole.xyz", whole_patches),
                                *options)
        lines = columns(whole)
        round_claims(bench, f"sphere, voxel {voxel}", lines, voxel)
        for name, patches in parts.items():
            part, _ = bench.meshed(name, write_plot3d(bench.folder / "part.xyz", patches), *options)
            if part is None:
                continue
            cells = sum((b.shape[1] - 1) * (b.shape[2] - 1) for b in part)
            wanted = sum((b.shape[1] - 1) * (b.shape[2] - 1) for b in whole)
            bench.claim(f"{name} of a sphere, voxel {voxel}: is that part of it",
                        cells * {"half": 2, "quarter": 4, "eighth": 8}[name] == wanted,
                        f"{cells} of {wanted} columns of cells")
            bench.below(f"{name} of a sphere, voxel {voxel}: off the whole's, radii",
                        difference(columns(part), lines) / radius, 1e-9)


def oblique_walls(bench):
    distance, first, layers = 0.4, 0.004, 12
    heights = level_heights(distance, first, layers)
    for degrees in (60, 90, 105, 120, 135):
        surface = write_plot3d(bench.folder / "wall.xyz", [wall_at_plane(81, 5, degrees)])
        # The distance to the wall and its image: the foot of a point on the plane lies on the wall
        # where that leans over the plane, else on the edge.
        sine = np.sin(np.radians(degrees)) if degrees < 90 else 1.0
        for repair in ("off", "on"):
            for voxel in (0.05, 0.03, 0.017):
                name = f"wall at {degrees} degrees, voxel {voxel}, repair {repair}"
                blocks, report = bench.meshed(
                    name, surface, "--plane", "x=0:plane", "--open-edges", "splay", "--splay", 0,
                    "--distance", distance, "--first-cell", first, "--layers", layers, "--voxel",
                    voxel, "--repair", repair, *SETTLED)
                if blocks is None:
                    continue
                lines = columns(blocks)
                on = lines[(lines[:, 0, 0] == 0) & (np.abs(lines[:, 0, 1] - 0.5) < 0.49)]
                bench.claim(f"{name}: on the plane, and none beyond",
                            np.all(on[..., 0] == 0) and lines[..., 0].min() >= 0 and len(on) == 3,
                            f"{len(on)} columns, {np.abs(on[..., 0]).max():g}, "
                            f"{lines[..., 0].min():g}")
                off = np.abs(on[..., 2] * sine - heights).max() / distance
                bench.below(f"{name}: levels on the plane off their distance", off, 1e-6)
                bad = report["quality"]["nonpositive_cells"]
                own = bad_cells(blocks)
                bench.claim(f"{name}: bad cells, the report's and this script's",
                            bad == own and (repair == "off" or bad == 0), f"{bad}, {own}")


def sphere_pair(bench):
    distance, first, layers, margin = 0.5, 0.005, 16, 0.1
    heights = level_heights(distance, first, layers)
    ratio = max(1.2, (heights[2] - heights[1]) / heights[1])
    for part in (0.2, 0.01):
        gap = part * distance
        surface = bench.example("sphere-pair", "--points", 17, "--gap", gap)
        for voxel in (0.04, 0.02):
            name = f"spheres {part} d apart, voxel {voxel}"
            blocks, report = bench.meshed(name, surface, "--distance", distance, "--first-cell",
                                          first, "--layers", layers, "--voxel", voxel,
                                          to="pair.vtm")
            if blocks is None:
                continue
            grids = [b["points"] for b in blocks]
            # The plane x = 0 is between them: a cell lies within the hull of its corners.
            apart = min((np.sign(g[0, 0, 0, 0]) * g[..., 0]).min() for g in grids)
            bench.claim(f"{name}: no cell of either meets the plane between", apart > 0,
                        f"points nearest to it at {apart / gap:.3g} of the gap")
            wall = Walls.of(grids)
            middle = np.sign(wall.places[:, :1]) * [1 + gap / 2, 0, 0]
            radius = wall.places - middle
            towards = radius[:, 0] * wall.places[:, 0] < 0
            with np.errstate(divide="ignore"):
                free = np.where(towards, np.abs(middle[:, 0] / radius[:, 0]) - 1, np.inf)
            facing_claims(bench, name, (blocks, report, wall), free,
                          {"distance": distance, "voxel": voxel, "ratio": ratio, "margin": margin})


def facing_claims(bench, name, made, free, law):
    """The room of columns whose free heights are known, and the coverage that follows."""
    blocks, report, wall = made
    distance, voxel = law["distance"], law["voxel"]
    room = np.empty(len(wall.places))
    for nodes, block in zip(wall.of_block, blocks):
        room[nodes] = block["room"][0].ravel()
    off = np.abs(np.minimum(room, distance) - np.minimum(free, distance)).max() / voxel
    bench.below(f"{name}: free room off that to the medial axis, voxels", off, 0.1)
    seen = distance / (1 - law["margin"])
    heights = np.where(free < seen, (1 - law["margin"]) * free, distance)
    expected = wall.coverage(wall.graded(np.minimum(heights, distance), law["ratio"]), distance)
    table = np.array([[row["mean"], row["min"]] for row in report["coverage"]])
    bench.below(f"{name}: coverage table off the exact one, voxels",
                np.abs(table - expected).max() * distance / voxel, 0.1)


def channel_room(feet):
    """Free heights in the channel: its floor is at 0.2 up to x = 1, at 0 behind; the roof at 1.
    The medial axis is flat but for a parabola between lip and roof; columns in the corner behind
    the step go on along its bisector, and then as far as where lip, floor and roof are as near."""
    u, z = feet[:, 0] - 1, feet[:, 2]
    roof = np.where(u <= 0, 0.4, np.minimum(0.5, 0.4 + u**2 / 1.6))
    floor = np.where(u > 1e-9, 0.5, 0.4)
    step = np.where(z < 0.199, 0.5, 0.8 / (1 + np.sqrt(0.5)))
    return np.where(z > 0.9, roof, np.where(np.abs(u) < 1e-9, step, floor))


def channel_distance(points):
    """True distance to the walls."""
    x, z = points[..., 0], points[..., 2]
    upper = np.hypot(np.maximum(x - 1, 0), z - 0.2)
    side = np.hypot(x - 1, np.maximum(z - 0.2, 0))
    lower = np.where(x > 1, z, np.inf)
    return np.minimum.reduce([upper, side, lower, 1 - z])


def channel(bench):
    distance, first, layers, margin = 0.6, 0.006, 16, 0.1
    heights = level_heights(distance, first, layers)
    ratio = max(1.2, (heights[2] - heights[1]) / heights[1])
    surface = bench.example("channel", "--points", 17)
    for repair in ("off", "on"):
        for voxel in (0.1, 0.05, 0.025, 0.0125):
            name = f"channel with a step, voxel {voxel}, repair {repair}"
            blocks, report = bench.meshed(name, surface, "--distance", distance, "--first-cell",
                                          first, "--layers", layers, "--voxel", voxel, "--repair",
                                          repair, to="channel.vtm")
            if blocks is None:
                continue
            grids = [b["points"] for b in blocks]
            gap = min(polyline_gap(np.concatenate([g[-1, j][:, ::2] for g in grids[:3]]),
                                   grids[3][-1, j][:, ::2]) for j in range(grids[0].shape[1]))
            bench.claim(f"{name}: outer levels of floor and roof do not meet", gap > 0,
                        f"apart by {gap / 0.8:.3g} of the room between")
            wall = Walls.of(grids)
            if repair == "off":  # it moves columns off the places that the formula is for
                facing_claims(bench, name, (blocks, report, wall), channel_room(wall.places),
                              {"distance": distance, "voxel": voxel, "ratio": ratio,
                               "margin": margin})
            ends = np.empty_like(wall.places)
            for nodes, grid in zip(wall.of_block, grids):
                ends[nodes] = grid[-1].reshape(-1, 3)
            reached = wall.coverage(channel_distance(ends), distance)
            table = np.array([[row["mean"], row["min"]] for row in report["coverage"]])
            bench.below(f"{name}: coverage table off the outer level's true distances, voxels",
                        np.abs(table - reached).max() * distance / voxel, 0.1)


def chord(file):
    rows = [line.split() for line in file.read_text().splitlines()]
    if file.suffix == ".obj":
        return np.ptp([float(row[1]) for row in rows if row and row[0] == "v"])
    numbers = [row for row in rows if len(row) == 2 and re.fullmatch(r"[-+.\deE]+", row[0])]
    return np.ptp([float(row[0]) for row in numbers if abs(float(row[0])) < 2])


def airfoils(bench):
    files = sorted((bench.data / "airfoil").glob("*.[do]*"))
    if not files:
        print(f"skipped: {bench.data / 'airfoil'} is not here")
    for file in files:
        size = chord(file)
        code, said, blocks, report = bench.mesh(file, "--distance", 0.1 * size, "--layers", 32,
                                                "--first-cell", 1e-4 * size)
        if blocks is None:
            bench.claim(f"{file.name}: refused with a reason", code == 2 and "error" in said,
                        said.strip()[-300:])
            continue
        bad, own = report["quality"]["nonpositive_cells"], bad_quads(blocks)
        cells = sum((b.shape[0] - 1) * (b.shape[1] - 1) for b in blocks)
        bench.claim(f"{file.name}: meshed, bad cells of the report and by this script's corners",
                    code == 0 and bad == own == 0 and cells == report["blocks"]["cells"],
                    f"{bad}, {own} of {cells}, least scaled Jacobian "
                    f"{report['quality']['min_scaled_jacobian']:.3f}")


def circle(bench):
    surface = write_plot3d(bench.folder / "circle.xyz", [regular_circle(64, 1.0)])
    for voxel in (0.125, 0.08):
        blocks, _ = bench.meshed("circle", surface, "--distance", 1, "--first-cell", 0.01,
                                 "--layers", 16, "--voxel", voxel, *SETTLED)
        if blocks is None:
            continue
        round_claims(bench, f"circle, voxel {voxel}", columns(blocks), voxel)


def extruded_airfoil(bench):
    curve = naca(33)
    flat = write_plot3d(bench.folder / "curve.xyz", [curve])
    for voxel in (0.01, 0.005):
        options = ("--distance", 0.1, "--layers", 32, "--first-cell", 1e-4, "--voxel", voxel)
        plane, _ = bench.meshed("airfoil in two dimensions", flat, *options)
        for cells in (2, 5):
            name = f"airfoil extruded over {cells} cells, voxel {voxel}"
            wall = write_plot3d(bench.folder / "wall.xyz", [extruded(curve, cells, 0.2)])
            blocks, _ = bench.meshed(name, wall, *options)
            if blocks is None or plane is None:
                continue
            lines = columns(blocks)
            bench.below(f"{name}: off the plane mesh, chords",
                        difference(lines[..., :2], columns(plane)), 1e-6)
            bench.below(f"{name}: columns off their z, chords",
                        np.abs(lines[..., 2] - lines[:, :1, 2]).max(), 1e-6)
            ends = max(off_plane(lines, 2, z, 1.0)[1] for z in (0.0, 0.2))
            bench.below(f"{name}: side faces off the planes, chords", ends, 1e-12)


PARTS = (draft_tube, symmetry_planes, parts_of_a_sphere, oblique_walls, sphere_pair, channel,
         airfoils, circle, extruded_airfoil)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help=", ".join(part.__name__ for part in PARTS))
    parser.add_argument("--data", type=Path, default=DATA, help="folder of surfaces of others")
    parser.add_argument("--keep", type=Path, help="folder of surfaces and the last meshes")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="vdb-offset-domains-") as scratch:
        folder = options.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        bench = Bench(folder, options.data, options.threads)
        for part in PARTS:
            if options.only in part.__name__:
                part(bench)
    print(f"{bench.passed} passed, {bench.failed} failed")
    sys.exit(1 if bench.failed or not bench.passed else 0)


if __name__ == "__main__":
    main()
