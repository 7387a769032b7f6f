"""VTK as an outside judge: reads our files and computes quality and distance by its own code."""

from _command import skip

try:
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    import numpy as np
except ImportError:
    skip("python3-vtk9 is not installed")


def read_vtm(vtm):
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(vtm))
    reader.Update()
    return reader.GetOutput()


def children(group):
    """Name and content of each child of a multi-block group."""
    name = vtk.vtkCompositeDataSet.NAME()
    return [(group.GetMetaData(n).Get(name), group.GetBlock(n))
            for n in range(group.GetNumberOfBlocks())]


def blocks(vtm):
    """The structured grids of a .vtm file, without the group of their boundaries."""
    return [grid for _, grid in children(read_vtm(vtm)) if grid.IsA("vtkStructuredGrid")]


def boundaries(vtm):
    """The grids of each boundary of a .vtm file, by its name."""
    groups = dict(children(read_vtm(vtm))).get("boundaries")
    return {name: [grid for _, grid in children(group)] for name, group in children(groups)}


def points(grid):
    """Points as an array [k, j, i, 3]."""
    ni, nj, nk = grid.GetDimensions()
    return vtk_to_numpy(grid.GetPoints().GetData()).reshape(nk, nj, ni, 3)


def point_data(grid, name):
    ni, nj, nk = grid.GetDimensions()
    return vtk_to_numpy(grid.GetPointData().GetArray(name)).reshape(nk, nj, ni)


def cell_data(grid, name):
    return vtk_to_numpy(grid.GetCellData().GetArray(name))


def measured(grid, measure):
    """A measure of every cell by VTK's Verdict: "ScaledJacobian", "Skew" ..."""
    quality = vtk.vtkMeshQuality()
    quality.SetInputData(grid)
    getattr(quality, "SetHexQualityMeasureTo" + measure)()
    quality.Update()
    return vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality"))


def scaled_jacobians(grid):
    return measured(grid, "ScaledJacobian")


def corners(grid):
    """The eight corners of every cell in VTK's order, as an array [cell, corner, 3]."""
    p = points(grid)
    ring = [(0, 0), (0, 1), (1, 1), (1, 0)]
    nk, nj, ni = (n - 1 for n in p.shape[:3])
    parts = [p[k:k + nk, j:j + nj, i:i + ni] for k in (0, 1) for j, i in ring]
    return np.stack(parts, -2).reshape(-1, 8, 3)


def edge_ratios(grid):
    """Longest over shortest edge of every cell. VTK 9.1 looks for the longest among six of the
    twelve edges, others as the cell is turned: the largest of three turns is meant."""
    turn = [0, 3, 7, 4, 1, 2, 6, 5]
    cells, ratios = corners(grid), []
    for _ in range(3):
        coordinates = vtk.vtkPoints()
        coordinates.SetDataTypeToDouble()
        flat = np.ascontiguousarray(cells.reshape(-1, 3))
        coordinates.SetData(numpy_to_vtk(flat, deep=1))
        hexahedra = vtk.vtkCellArray()
        hexahedra.SetData(8, numpy_to_vtkIdTypeArray(np.arange(len(flat)), deep=1))
        turned = vtk.vtkUnstructuredGrid()
        turned.SetPoints(coordinates)
        turned.SetCells(vtk.VTK_HEXAHEDRON, hexahedra)
        ratios.append(measured(turned, "EdgeRatio"))
        cells = cells[:, turn]
    return np.max(ratios, axis=0)


def corner_jacobians(grid):
    """The least of a cell's eight corner determinants, of edges as long as they are."""
    cell = corners(grid)
    least = np.full(len(cell), np.inf)
    for n in range(8):
        above = (n + 4) % 8
        ahead, behind = (n + 1) % 4 + n // 4 * 4, (n + 3) % 4 + n // 4 * 4
        a, b, c = (cell[:, m] - cell[:, n] for m in (ahead, behind, above))
        determinant = (np.cross(a, b) * c).sum(-1)
        least = np.minimum(least, determinant if n < 4 else -determinant)
    return least


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
