"""Surfaces whose layers are known by formulas, as arrays [j, i, 3] and curves [i, 3]."""

import numpy as np


def cube_sphere(cells, radius):
    """Six patches of 2 x cells a side, normals outward, mirrored in x, y, z = 0 to the bit."""
    half = np.tan(np.pi / 4 * np.arange(1, cells + 1) / cells)
    half[-1] = 1
    ticks = np.concatenate([-half[::-1], [0], half])
    u, v = np.meshgrid(ticks, ticks)
    patches = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            cube = np.empty((*u.shape, 3))
            cube[..., axis] = sign
            cube[..., (axis + 1) % 3] = u if sign > 0 else v
            cube[..., (axis + 2) % 3] = v if sign > 0 else u
            # In one order whatever the face, so that shared points are the same.
            length = np.sqrt(np.sort(cube**2, axis=-1).sum(-1, keepdims=True))
            patches.append(radius * cube / length)
    return patches


def halved(patches, axis):
    """Their part where x_axis >= 0; a grid line lies on 0."""
    kept = []
    for patch in patches:
        inside = patch[..., axis] >= 0
        part = patch[inside.any(1)][:, inside.any(0)]
        if min(part.shape[:2]) > 1:
            kept.append(part)
    return kept


def wall_at_plane(along, across, degrees):
    """A flat wall, 2 x 1, that meets x = 0 at an angle, measured in the flow above it."""
    lean = np.radians(degrees - 90)
    u, v = np.meshgrid(np.linspace(0, 2, along), np.linspace(0, 1, across))
    return np.stack([u * np.cos(lean), v, -u * np.sin(lean)], -1)


def regular_circle(points, radius):
    """A closed curve, counter-clockwise."""
    angles = 2 * np.pi * np.arange(points) / points
    ring = radius * np.stack([np.cos(angles), np.sin(angles), np.zeros(points)], -1)
    return np.concatenate([ring, ring[:1]])


def naca(points, thickness=0.12):
    """A symmetric four-digit section of chord 1, its trailing edge sharp: counter-clockwise."""
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, points)))
    shape = 0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
    y = 5 * thickness * shape
    y[-1] = 0
    x, y = np.concatenate([x[::-1], x[1:]]), np.concatenate([y[::-1], -y[1:]])
    return np.stack([x, y, np.zeros(len(x))], -1)


def extruded(curve, cells, width):
    """The curve from z = 0 to z = width, normals to its right."""
    z = width * np.arange(cells + 1) / cells
    wall = np.repeat(curve[None], cells + 1, axis=0)
    wall[..., 2] = z[:, None]
    return wall
