"""CAD solids much thinner than cells are wide: layers on both sides, judged by VTK."""

from pathlib import Path

from _command import check, check_exit, finish, run, scratch, skip
from _step import Step
from _vtk import scaled_jacobians, vtk

HIGH, SIZE, DISTANCE = 2e-4, 0.2, 0.2


def plate(step, open_side=False):
    """2 x 2 x HIGH; but for the side x = 2."""
    def at(x, y, z):
        return (x, y, HIGH * z)
    rings = {"floor": [(0, 0, 0), (0, 2, 0), (2, 2, 0), (2, 0, 0)],
             "roof": [(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)],
             "front": [(0, 0, 0), (2, 0, 0), (2, 0, 1), (0, 0, 1)],
             "back": [(0, 2, 0), (0, 2, 1), (2, 2, 1), (2, 2, 0)],
             "left": [(0, 0, 0), (0, 0, 1), (0, 2, 1), (0, 2, 0)]}
    if not open_side:
        rings["right"] = [(2, 0, 0), (2, 2, 0), (2, 2, 1), (2, 0, 1)]
    return [step.face(name, [at(*p) for p in ring]) for name, ring in rings.items()]


def read(file):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


with scratch() as folder:
    folder = Path(folder)

    def mesh(name, open_side=False, *more):
        step = Step()
        step.write(folder / name, plate(step, open_side))
        return run("mesh", folder / name, "--surface-size", SIZE, "--distance", DISTANCE,
                   "--layers", 3, "-o", folder / "a.vtu", *more)

    said = mesh("plate.step")
    if "without OpenCASCADE" in said.stderr:
        skip("built without OpenCASCADE")
    check_exit("a thin plate", said, 0, "closed", "thinner than two voxels", "'roof'", "'floor'")
    grid = read(folder / "a.vtu")
    lo, hi = grid.GetBounds()[4:]
    check("layers are on both sides",
          abs(lo + DISTANCE) < 1e-9 and abs(hi - HIGH - DISTANCE) < 1e-9, (lo, hi))
    check("no cell is bad", scaled_jacobians(grid).min() > 0.5, scaled_jacobians(grid).min())

    said = mesh("half.step", True)
    check_exit("one that ends on a plane", said, 0, "22 free edges", "(plane x = 2, 22 edges)")
    check("its rim is no gap", "--weld" not in said.stderr, said.stderr)
    grid = read(folder / "a.vtu")
    hi = grid.GetBounds()[1]
    check("layers end on the plane", abs(hi - 2) < 1e-9, hi)
    check("no cell of it is bad", scaled_jacobians(grid).min() > 0.5, scaled_jacobians(grid).min())

finish()
