"""Grids by numpy alone: files by their formats, cells by their corners, layers by their law."""

import itertools
import re
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np


def records(file):
    """The payloads of a Fortran unformatted file."""
    data, at = Path(file).read_bytes(), 0
    while at < len(data):
        (size,) = struct.unpack_from("<i", data, at)
        yield data[at + 4:at + 4 + size]
        (again,) = struct.unpack_from("<i", data, at + 4 + size)
        if again != size:
            raise ValueError(f"{file}: record marks {size} and {again}")
        at += 8 + size


def read_plot3d(file):
    """Blocks of doubles as arrays [k, j, i, 3], of plane ones [k, i, 2]."""
    payloads = records(file)
    count = int(np.frombuffer(next(payloads), "<i4")[0])
    sizes = np.frombuffer(next(payloads), "<i4").reshape(count, -1)
    grids = [np.frombuffer(next(payloads), "<f8").reshape(len(size), *size[::-1]) for size in sizes]
    return [np.moveaxis(grid, 0, -1) for grid in grids]


def read_plot3d_text(file):
    """Patches of a formatted file as arrays [j, i, 3]."""
    words = Path(file).read_text().split()
    count = int(words[0])
    sizes = np.array(words[1:1 + 3 * count], int).reshape(count, 3)
    values, grids = np.array(words[1 + 3 * count:], float), []
    for size in sizes:
        taken, values = np.split(values, [3 * size.prod()])
        grids.append(np.moveaxis(taken.reshape(3, size[1], size[0]), 0, -1))
    return grids


def write_plot3d(file, patches):
    """Patches [j, i, 3], or curves [i, 3], as surfaces of doubles."""
    patches = [p if p.ndim == 3 else p[None] for p in patches]
    sizes = np.array([[p.shape[1], p.shape[0], 1] for p in patches], "<i4")
    payloads = [np.array([len(patches)], "<i4").tobytes(), sizes.tobytes()]
    payloads += [np.moveaxis(p, -1, 0).astype("<f8").tobytes() for p in patches]
    with open(file, "wb") as out:
        for payload in payloads:
            mark = struct.pack("<i", len(payload))
            out.write(mark + payload + mark)
    return Path(file)


TYPES = {"Float64": "<f8", "Float32": "<f4", "UInt8": "u1", "Int32": "<i4"}


def read_vts(file):
    """The arrays of one structured grid, raw appended: name to [k, j, i(, components)]."""
    data = Path(file).read_bytes()
    start = data.index(b'<AppendedData encoding="raw">')
    head, start = data[:start].decode(), data.index(b"_", start) + 1
    extent = list(map(int, re.search(r'Piece Extent="([^"]*)"', head)[1].split()))
    ni, nj, nk = (extent[2 * a + 1] - extent[2 * a] + 1 for a in range(3))
    points_end = head.index("<CellData")
    arrays = {}
    for tag in re.findall(r"<DataArray [^>]*>", head[:points_end]):
        said = dict(re.findall(r'(\w+)="([^"]*)"', tag))
        at = start + int(said["offset"])
        (size,) = struct.unpack_from("<Q", data, at)
        values = np.frombuffer(data[at + 8:at + 8 + size], TYPES[said["type"]])
        shape = (nk, nj, ni, 3) if said.get("NumberOfComponents") == "3" else (nk, nj, ni)
        arrays[said["Name"]] = values.reshape(shape)
    return arrays


def read_vtm(file):
    """The blocks of a `.vtm`, in order."""
    pieces = [p for p in Path(file).with_suffix("").iterdir()
              if re.fullmatch(r"block_\d+\.vts", p.name)]
    return [read_vts(p) for p in sorted(pieces, key=lambda p: int(p.stem.split("_")[1]))]


def columns(blocks):
    """All columns as an array [column, level, axis]; those of shared sides come twice."""
    return np.concatenate([np.moveaxis(b.reshape(len(b), -1, b.shape[-1]), 0, 1) for b in blocks])


def level_heights(distance, first, layers):
    """The geometric law: cells s, s g, s g^2 ... that add up to the distance; g by bisection."""
    powers = np.arange(layers)
    low, high = 0.1, 10.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if first * (middle**powers).sum() < distance else (low, middle)
    return np.concatenate([[0], np.cumsum(first * (0.5 * (low + high))**powers)])


def corners_of(block):
    """The eight corners of each cell, by their offsets (k, j, i)."""
    size = [n - 1 for n in block.shape[:3]]
    return {at: block[tuple(slice(o, o + n) for o, n in zip(at, size))]
            for at in itertools.product((0, 1), repeat=3)}


def bad_cells(blocks):
    """Cells of which a corner, or a tetrahedron around the diagonal, is not positive, or a corner
    is flat to rounding."""
    bad = 0
    for block in blocks:
        corner = corners_of(block)
        wrong = np.zeros(corner[0, 0, 0].shape[:3], bool)
        for at, here in corner.items():
            ends = [corner[tuple(o ^ (axis == a) for a, o in enumerate(at))] for axis in (2, 1, 0)]
            edges = [end - here for end in ends]
            lengths = np.prod([np.linalg.norm(edge, axis=-1) for edge in edges], 0)
            turned = -1 if sum(at) % 2 else 1
            wrong |= ~(turned * determinant(*edges) > 1e-9 * lengths)
        for order in itertools.permutations(range(3)):
            way = [corner[tuple(int(a in order[:n]) for a in range(3))] for n in range(4)]
            turned = np.linalg.det(np.eye(3)[list(order)])
            wrong |= ~(-turned * determinant(*np.diff(way, axis=0)) > 0)
        bad += int(wrong.sum())
    return bad


def determinant(a, b, c):
    return (np.cross(a, b) * c).sum(-1)


CORNERS = [(0, 0), (0, 1), (1, 1), (1, 0)]  # (j, i), around a face


def bad_quads(blocks):
    """The same of plane blocks [k, i, 2]; i runs so that i x k is positive."""
    bad = 0
    for block in blocks:
        p = [block[b:len(block) - 1 + b, a:block.shape[1] - 1 + a] for b, a in CORNERS]
        least = np.full(p[0].shape[:2], np.inf)
        for n in range(4):
            a, b = p[(n + 1) % 4] - p[n], p[(n + 3) % 4] - p[n]
            lengths = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
            sine = (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) / np.maximum(lengths, 1e-300)
            least = np.minimum(least, sine)
        bad += int((~(least > 1e-9)).sum())
    return bad


def difference(part, whole):
    """Largest distance of any level between columns that stand on the same place; infinite where
    one of `part` stands on none of `whole`."""
    worst = 0.0
    for column in part:
        off = np.linalg.norm(whole[:, 0] - column[0], axis=-1)
        nearest = off.argmin()
        if off[nearest] > 1e-9:
            return np.inf
        worst = max(worst, np.linalg.norm(whole[nearest] - column, axis=-1).max())
    return worst


def polyline_gap(a, b):
    """The distance between two polylines [point, 2]; 0 where they cross."""
    def cross(v, w):
        return v[..., 0] * w[..., 1] - v[..., 1] * w[..., 0]

    def sides(p, q):
        """On which sides of the lines of p's segments the points of q lie."""
        return np.sign(cross((p[1:] - p[:-1])[:, None], q[None] - p[:-1, None]))

    def nearest(p, q):
        way = p[1:] - p[:-1]
        along = ((q[None] - p[:-1, None]) * way[:, None]).sum(-1)
        along = along / np.maximum((way**2).sum(-1), 1e-300)[:, None]
        foot = p[:-1, None] + np.clip(along, 0, 1)[..., None] * way[:, None]
        return np.linalg.norm(q[None] - foot, axis=-1).min()

    over, under = sides(a, b), sides(b, a).T
    meets = (over[:, 1:] * over[:, :-1] <= 0) & (under[1:] * under[:-1] <= 0)
    return 0.0 if meets.any() else min(nearest(a, b), nearest(b, a))


@dataclass
class Walls:
    """The nodes of a wall of structured blocks, and their neighbours along grid lines."""

    places: np.ndarray  # [node, 3]
    of_block: list  # of each block the nodes of its columns
    edges: np.ndarray  # pairs

    @staticmethod
    def of(blocks):
        feet = np.concatenate([b[0].reshape(-1, 3) for b in blocks])
        # Off the middle between two decimals, where short ones stand.
        _, first, node = np.unique(np.round(feet + 0.317e-9, 9), axis=0,
                                   return_index=True, return_inverse=True)
        parts = np.split(node.ravel(), np.cumsum([b[0, ..., 0].size for b in blocks])[:-1])
        pairs = []
        for part, block in zip(parts, blocks):
            grid = part.reshape(block.shape[1:3])
            pairs += [np.stack([grid[:, :-1].ravel(), grid[:, 1:].ravel()], 1),
                      np.stack([grid[:-1].ravel(), grid[1:].ravel()], 1)]
        return Walls(feet[first], parts, np.concatenate(pairs))

    def graded(self, heights, ratio):
        """The greatest heights below these that the README's rule for neighbours allows."""
        a, b = self.edges.T
        length = np.linalg.norm(self.places[a] - self.places[b], axis=1)
        a, b, length = np.concatenate([a, b]), np.concatenate([b, a]), np.tile(length, 2)
        heights = heights.copy()
        while True:
            most = np.maximum(heights[a] * ratio, heights[a] + 0.25 * length)
            lower = heights.copy()
            np.minimum.at(lower, b, np.minimum(most, heights[a] + length))
            if np.array_equal(lower, heights):
                return heights
            heights = lower

    def coverage(self, heights, distance):
        """Mean and least of each block."""
        parts = [np.minimum(heights[np.unique(nodes)] / distance, 1) for nodes in self.of_block]
        return np.array([[part.mean(), part.min()] for part in parts])
