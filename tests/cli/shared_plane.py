"""Inlet and outlet of a bend that comes back lie in one plane, and have names of their own."""

import json
import math
from pathlib import Path

from _command import check, check_exit, finish, run, scratch
from _vtk import boundaries, points

RADIUS = 1.5  # of the bend
NI, NJ = 17, 33


def middle(part):
    length = 4 + math.pi * RADIUS
    s = part * length
    if s <= 2:
        return (0.0, s), (-1.0, 0.0)
    if s >= 2 + math.pi * RADIUS:
        return (2 * RADIUS, length - s), (1.0, 0.0)
    angle = (s - 2) / RADIUS
    out = (-math.cos(angle), math.sin(angle))
    return (RADIUS + RADIUS * out[0], 2 + RADIUS * out[1]), out


def pipe(file):
    """Radius 0.6, normals inward."""
    grid = []
    for j in range(NJ):
        (x, y), out = middle(j / (NJ - 1))
        for i in range(NI):
            angle = 2 * math.pi * (i % (NI - 1)) / (NI - 1)
            r = 0.6 * math.cos(angle)
            grid.append((x + r * out[0], y + r * out[1], -0.6 * math.sin(angle)))
    values = [repr(p[axis]) for axis in range(3) for p in grid]
    file.write_text(f"1\n{NI} {NJ} 1\n" + "\n".join(values) + "\n")
    return file


with scratch() as folder:
    folder = Path(folder)
    bend = pipe(folder / "bend.fmt")

    def mesh(*options, surface=bend):
        return run("mesh", surface, "--distance", 0.1, "--layers", 4, "--first-cell", 0.01,
                   "--report", folder / "report.json", *options)

    def ends(inlet, outlet, vtm):
        """Whether each name is that of the faces at its end, and of no others."""
        named = boundaries(vtm)
        at = {name: [points(grid)[..., 0].mean() for grid in named.get(name, [])]
              for name in (inlet, outlet)}
        return (at[inlet] and at[outlet] and all(abs(x) < 0.1 for x in at[inlet])
                and all(abs(x - 2 * RADIUS) < 0.1 for x in at[outlet])), at

    vtm = folder / "out.vtm"
    made = mesh("-o", vtm)
    check_exit("found", made, 0, "'opening'", "'opening 2'")
    check("openings are two boundaries", *ends("opening", "opening 2", vtm))
    case = folder / "case"
    both = ["--plane", "0,0,0/0,1,0:inlet", "--plane", "3,0,0/0,1,0:outlet"]
    made = mesh(*both, "-o", vtm, "-o", folder / "out.cgns", "-o", str(case) + "/", "-o",
                folder / "out.su2", "--topology", folder / "out.json")
    check_exit("named by points", made, 0, "'inlet' (plane y = 0, 16 edges)",
               "'outlet' (plane y = 0, 16 edges)")
    check("each has its name", *ends("inlet", "outlet", vtm))
    report = json.loads((folder / "report.json").read_text())
    listed = {one["name"]: one for one in report["surface"]["boundaries"]}
    check("the report has both, each with a point of its own",
          set(listed) == {"inlet", "outlet"} and abs(listed["inlet"]["point"][0]) < 1e-9
          and abs(listed["outlet"]["point"][0] - 3) < 1e-9
          and all(one["free_edges"] == 16 for one in listed.values()), listed)
    info = json.loads(run("info", folder / "out.cgns", "--json").stdout)
    kinds = {family["name"]: family["type"] for family in info["families"]}
    check("CGNS has both, with their conditions",
          kinds.get("inlet") == "BCInflow" and kinds.get("outlet") == "BCOutflow", kinds)
    text = (case / "constant/polyMesh/boundary").read_text()
    faces = [text.split(name + "\n")[1].split("nFaces")[1].split(";")[0].strip()
             for name in ("inlet", "outlet")]
    check("OpenFOAM has the faces of each", faces == ["64", "64"], text)
    text = (folder / "out.su2").read_text()
    check("SU2 has both", "MARKER_TAG= inlet" in text and "MARKER_TAG= outlet" in text)
    again = folder / "again.vtm"
    made = mesh("-o", again, surface=folder / "out.json")
    check_exit("read again from the topology", made, 0)
    check("each has its name again", *ends("inlet", "outlet", again))
    made = mesh("--plane", "y=0:inlet", "--plane", "3,0,0/0,1,0:outlet", "-o", vtm, "--topology",
                folder / "out.json")
    check_exit("one by a point, and the rest", made, 0)
    check("the rest is the other end", *ends("inlet", "outlet", vtm))
    made = mesh("-o", again, surface=folder / "out.json")
    check("and from the topology", *ends("inlet", "outlet", again))
    check_exit("once: all of the plane", mesh("--plane", "y=0:both", "-o", vtm), 0, "'both'",
               "32 edges")
    twice = mesh("--plane", "y=0:inlet", "--plane", "y=0:outlet", "-o", vtm)
    check_exit("twice the rest", twice, 2, "nothing says which is which",
               "0,0,0/0,1,0 or 3,0,0/0,1,0")

finish()
