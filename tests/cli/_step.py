"""STEP files of plane faces, written as text."""

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


class Step:
    """Plane faces, each of edges of its own, in inches."""

    def __init__(self):
        self.lines = []

    def add(self, text):
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return f"#{len(self.lines)}"

    def point(self, p):
        return self.add(f"CARTESIAN_POINT('',({p[0]:.17g},{p[1]:.17g},{p[2]:.17g}))".replace(
            "e", "E"))

    def direction(self, d):
        length = sum(c * c for c in d) ** 0.5
        numbers = ",".join(f"{c / length:.17f}" for c in d)
        return self.add(f"DIRECTION('',({numbers}))")

    def face(self, name, corners, off=0):
        """`off`: how far its plane lies off, along z."""
        points = [self.point(p) for p in corners]
        vertices = [self.add(f"VERTEX_POINT('',{p})") for p in points]
        uses = []
        for n, start in enumerate(corners):
            end = corners[(n + 1) % len(corners)]
            way = self.direction([b - a for a, b in zip(start, end)])
            vector = self.add(f"VECTOR('',{way},1.)")
            line = self.add(f"LINE('',{points[n]},{vector})")
            edge = self.add(f"EDGE_CURVE('',{vertices[n]},{vertices[(n + 1) % len(corners)]},"
                            f"{line},.T.)")
            uses.append(self.add(f"ORIENTED_EDGE('',*,*,{edge},.T.)"))
        loop = self.add(f"EDGE_LOOP('',({','.join(uses)}))")
        bound = self.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
        a, b = ([q - p for p, q in zip(corners[0], corners[n])] for n in (1, -1))
        normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        x, y, z = corners[0]
        origin = self.point((x, y, z + off))
        axes = self.add(f"AXIS2_PLACEMENT_3D('',{origin},{self.direction(normal)},"
                        f"{self.direction(a)})")
        plane = self.add(f"PLANE('',{axes})")
        return self.add(f"ADVANCED_FACE('{name}',({bound}),{plane},.T.)")

    def write(self, file, faces, closed=False):
        """Each face a shell of its own, or one closed shell of all."""
        shells = ([self.add(f"CLOSED_SHELL('',({','.join(faces)}))")] if closed
                  else [self.add(f"OPEN_SHELL('',({face}))") for face in faces])
        model = self.add(f"SHELL_BASED_SURFACE_MODEL('',({','.join(shells)}))")
        millimetre = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        size = self.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
        measure = self.add(f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),{millimetre})")
        inch = self.add(f"(CONVERSION_BASED_UNIT('INCH',{measure})LENGTH_UNIT()NAMED_UNIT({size}))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        near = self.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),{inch},"
                        "'distance_accuracy_value','')")
        context = self.add("(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
                           f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({near}))"
                           f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({inch},{angle},{solid}))"
                           "REPRESENTATION_CONTEXT('',''))")
        shape = self.add("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',"
                         f"({model}),{context})")
        application = self.add("APPLICATION_CONTEXT('automotive_design')")
        of = self.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
        part = self.add(f"PRODUCT('part','part','',({of}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{part})")
        design = self.add(f"PRODUCT_DEFINITION_CONTEXT('',{application},'design')")
        definition = self.add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
        whole = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({whole},{shape})")
        file.write_text(HEAD + "\n".join(self.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n")


def cube(step, gap=0, inward=False):
    """`gap`: how far each face lies outside [0, 2]^3."""
    corner = [(x, y, z) for z in (0, 2) for y in (0, 2) for x in (0, 2)]
    sides = {"floor": (0, 2, 3, 1), "roof": (4, 5, 7, 6), "front": (0, 1, 5, 4),
             "back": (2, 6, 7, 3), "left": (0, 4, 6, 2), "right": (1, 3, 7, 5)}
    faces = []
    for name, ring in sides.items():
        corners = [corner[n] for n in (ring[::-1] if inward else ring)]
        out = [gap * (sum(c[n] for c in corners) / 4 - 1) for n in range(3)]
        faces.append(step.face(name, [[a + b for a, b in zip(c, out)] for c in corners]))
    return faces


def flat(step, name, x0, x1, z):
    return step.face(name, [(x0, 0, z), (x1, 0, z), (x1, 2, z), (x0, 2, z)])
