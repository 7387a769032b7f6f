"""CAD models and CGNS files of different units of length in one run."""

from pathlib import Path

from _command import check, check_exit, finish, run, scratch, skip
from _step import Step, flat

LAYERS = ["--distance", 0.2, "--layers", 2, "--surface-size", 0.5]


def write_sheet(file, unit, millimetres):
    """A square from 1 to 2 in the unit."""
    step = Step()
    step.write(file, [flat(step, "sheet", 1, 2, 0)])
    text = file.read_text()
    assert "'INCH'" in text and "(25.4)" in text
    file.write_text(text.replace("'INCH'", f"'{unit}'").replace("(25.4)", f"({millimetres})"))


def farthest(su2):
    lines = su2.read_text().split("NPOIN=")[1].splitlines()
    count = int(lines[0].split()[0])
    return max(float(line.split()[0]) for line in lines[1:count + 1])


with scratch() as folder:
    folder = Path(folder)
    write_sheet(folder / "inch.step", "INCH", "25.4")
    write_sheet(folder / "foot.step", "FOOT", "304.8")
    write_sheet(folder / "mile.step", "MILE", "1609344.")

    def mesh(names, output, *more):
        return run("mesh", *[folder / name for name in names], *LAYERS, "-o", folder / output,
                   *more)

    said = mesh(["inch.step", "foot.step"], "both.su2")
    if "without OpenCASCADE" in said.stderr:
        skip("built without OpenCASCADE")
    check_exit("the first file's unit is that of all", said, 0, "inch.step: 1 face",
               "lengths in inches", "lengths converted from feet to inches")
    check("feet are 12 inches", abs(farthest(folder / "both.su2") - 24) < 1e-12,
          farthest(folder / "both.su2"))
    said = mesh(["foot.step", "inch.step"], "both.su2")
    check_exit("feet first", said, 0, "lengths converted from inches to feet")
    check("the farthest is of the feet", abs(farthest(folder / "both.su2") - 2) < 1e-12,
          farthest(folder / "both.su2"))

    for unit in ("inch", "foot"):
        check_exit(f"{unit} as CGNS", mesh([f"{unit}.step"], f"{unit}.cgns"), 0)
    check_exit("CGNS files of two units", mesh(["inch.cgns", "foot.cgns"], "both.su2"), 2,
               "inch.cgns", "Inch", "foot.cgns", "Foot", "convert")
    check_exit("CAD files are converted to that of a CGNS file",
               mesh(["foot.step", "inch.cgns"], "both.su2"), 0,
               "lengths converted from feet to inches")
    check("24 inches", abs(farthest(folder / "both.su2") - 24) < 1e-12,
          farthest(folder / "both.su2"))

    said = mesh(["inch.step"], "with.su2", "--boundary", f"{folder / 'foot.cgns'}:b")
    check_exit("a CGNS boundary counts too", said, 2, "converted from inches to feet", "'b'")
    check_exit("and is refused with another one",
               mesh(["inch.cgns"], "with.su2", "--boundary", f"{folder / 'foot.cgns'}:b"), 2,
               "inch.cgns", "foot.cgns", "convert")

    check_exit("PLOT3D has no unit", run("example", "cube", "-o", folder / "cube.xyz"), 0)
    said = mesh(["inch.step", "cube.xyz"], "both.su2", "--outer-surface", folder / "out.step")
    check_exit("STEP has to say one", said, 0, "warning", "out.step", "millimetres")

    said = mesh(["mile.step"], "mile.cgns", "--outer-surface", folder / "out.step")
    check_exit("a unit that CGNS lacks", said, 0, "warning", "mile.cgns", "no unit of length")
    check("STEP has it", "'MILE'" in (folder / "out.step").read_text())

finish()
