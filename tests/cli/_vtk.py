"""VTK as an outside judge: reads our files and computes quality and distance by its own code."""

from _command import skip

try:
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    import numpy as np
except ImportError:
    skip("python3-vtk9 is not installed")


def blocks(vtm):
    """The structured grids of a .vtm file."""
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(vtm))
    reader.Update()
    walk = reader.GetOutput().NewIterator()
    grids = []
    while not walk.IsDoneWithTraversal():
        grids.append(walk.GetCurrentDataObject())
        walk.GoToNextItem()
    return grids


def points(grid):
    """Points as an array [k, j, i, 3]."""
    ni, nj, nk = grid.GetDimensions()
    return vtk_to_numpy(grid.GetPoints().GetData()).reshape(nk, nj, ni, 3)


def point_data(grid, name):
    ni, nj, nk = grid.GetDimensions()
    return vtk_to_numpy(grid.GetPointData().GetArray(name)).reshape(nk, nj, ni)


def scaled_jacobians(grid):
    quality = vtk.vtkMeshQuality()
    quality.SetInputData(grid)
    quality.SetHexQualityMeasureToScaledJacobian()
    quality.Update()
    return vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality"))


def corner_jacobians(grid):
    """The least of a cell's eight corner determinants, edges not normalised, i fastest."""
    p = points(grid)
    corner = lambda k, j, i: p[k:k + p.shape[0] - 1, j:j + p.shape[1] - 1, i:i + p.shape[2] - 1]
    least = np.full((p.shape[0] - 1, p.shape[1] - 1, p.shape[2] - 1), np.inf)
    for k, j, i in np.ndindex(2, 2, 2):
        here = corner(k, j, i)
        edges = [corner(k, j, 1 - i) - here, corner(k, 1 - j, i) - here, corner(1 - k, j, i) - here]
        sign = (-1) ** (i + j + k)  # an odd corner sees its three edges mirrored
        least = np.minimum(least, sign * (np.cross(edges[0], edges[1]) * edges[2]).sum(-1))
    return least.ravel()


def wall(grids):
    """Level 0 of all blocks as triangles: four a quad, about the mean of its corners."""
    corners, faces, start = [], [], 0
    for grid in grids:
        p = points(grid)[0]
        nj, ni, _ = p.shape
        centre = 0.25 * (p[:-1, :-1] + p[1:, :-1] + p[:-1, 1:] + p[1:, 1:])
        node = start + np.arange(ni * nj).reshape(nj, ni)
        middle = start + ni * nj + np.arange((ni - 1) * (nj - 1)).reshape(nj - 1, ni - 1)
        ring = [node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]]
        for s in range(4):
            faces.append(np.stack([middle, ring[s], ring[(s + 1) % 4]], -1).reshape(-1, 3))
        corners += [p.reshape(-1, 3), centre.reshape(-1, 3)]
        start += ni * nj + (ni - 1) * (nj - 1)
    coordinates = vtk.vtkPoints()
    coordinates.SetDataTypeToDouble()
    coordinates.SetData(numpy_to_vtk(np.ascontiguousarray(np.concatenate(corners)), deep=1))
    faces = np.concatenate(faces)
    cells = vtk.vtkCellArray()
    ids = np.ascontiguousarray(faces.ravel().astype(np.int64))
    cells.SetData(3, numpy_to_vtkIdTypeArray(ids, deep=1))
    surface = vtk.vtkPolyData()
    surface.SetPoints(coordinates)
    surface.SetPolys(cells)
    return surface


def distances(surface, queries):
    """Distance of each query to the nearest triangle, by VTK's cell locator."""
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    nearest, distance2 = [0.0] * 3, vtk.reference(0.0)
    cell, sub = vtk.reference(0), vtk.reference(0)
    result = []
    for q in queries:
        locator.FindClosestPoint(q, nearest, cell, sub, distance2)
        result.append(distance2.get() ** 0.5)
    return np.array(result)
