"""Every example as an OpenFOAM case: checkMesh finds the mesh in order; types of patches."""

from pathlib import Path

from _command import check, check_exit, finish, run, scratch
from _openfoam import judged, note, patches

CURVES = {"airfoil", "circle"}
# Distance, first cell and layers that keep aspect ratios below checkMesh's limit, 1000.
USUAL = ("--distance", 0.05, "--first-cell", 0.005, "--layers", 5)
# Large for that distance: thicker, for the time it takes.
LARGE = {"fuselage", "torus", "sphere", "sphere-pair", "draft-tube", "wing-on-cylinder"}
THICKER = ("--distance", 0.15, "--first-cell", 0.015, "--layers", 5)
# Without fans the faces off the tips are more askew than checkMesh allows.
FURTHER = {"star": ("--fans", 2)}


def mesh(surface, out, *options):
    made = run("mesh", surface, "-o", out, "--quiet", *options)
    check_exit(f"mesh {Path(surface).stem} {' '.join(map(str, options))}", made, 0)


with scratch() as folder:
    folder = Path(folder)
    names = [line.split()[0] for line in run("example").stdout.splitlines()]
    check("there are examples", len(names) > 10, names)
    for name in names:
        surface = folder / f"{name}.cgns" if name not in CURVES else folder / f"{name}.xyz"
        check_exit(f"example {name}", run("example", name, "-o", surface, "--points", 9), 0)
        mesh(surface, f"{folder / name}/", *(THICKER if name in LARGE else USUAL),
             *FURTHER.get(name, ()))
        judged(folder / name)
        found = patches(folder / name)
        check(f"{name}: patches follow one another to the last face",
              [start for _, _, start in found.values()][1:] + [note(folder / name)["nFaces"]]
              == [start + faces for _, faces, start in found.values()], found)
        check(f"{name}: it has walls, and an outer patch",
              "wall" in {kind for kind, _, _ in found.values()} and found["outer"][0] == "patch",
              found)

    kinds = {name: kind for name, (kind, _, _) in patches(folder / "circle").items()}
    check("a flat mesh lies between empty patches",
          (kinds["front"], kinds["back"]) == ("empty", "empty"), kinds)
    kinds = {name: kind for name, (kind, _, _) in patches(folder / "quarter-cylinder").items()}
    check("flat symmetry is a symmetryPlane", kinds["symmetry"] == "symmetryPlane", kinds)

finish()
