"""The numbers that decide how manifests and meshes are read, by the module that uses them.

What users may set is in `Tolerances`. Where no measurement is named, a number is a choice.
"""

from __future__ import annotations

# ---- limits of what is read: beyond them input is refused before it costs memory or time

LARGEST_NUMBER = 1e18
"""The largest magnitude of a stated number, coordinates of meshes included: sixth powers of it, in whatever unit, are
still finite, in our code and in FCL's. A thousand million kilometres in micrometres is no more."""

COUNT_MOST = 1_000_000
"""The largest mobility that can be stated: more than six times the parts that a design may have."""

NAME_LENGTH = 255
"""Characters of a name, and of a key of a table: what a file system lets a file's name have."""

PATH_LENGTH = 4095
"""Characters of the path of a file: what Linux takes."""

MANIFEST_BYTES = 2 << 20
"""Bytes of a manifest: 10,000 parts with poses. Values, places and complaints take 200 times that at worst, 400 MB."""

MANIFEST_DEPTH = 8
"""Tables in tables, arrays in arrays, and keys between dots: schema 1 goes six deep."""

BARE_LENGTH = 255
"""Characters of a bare key, a number or a date in TOML: doubles take 25 at most, and names have quotes."""

PROBLEMS_MOST = 1000
"""Problems of the input that are told: who has more repairs these first."""

TABLE_BYTES = 8 << 20
"""Bytes of a CSV file: half a million rows. A row of 8 bytes takes 300 as numbers, so that all take 300 MB."""

SCOPES_MOST = 10_000
"""Sub-assemblies of a design, counted each time that they are placed: of files that place each other twice there could
be more than atoms."""

SCOPES_DEEP = 32
"""Sub-assemblies in each other."""

PARTS_MOST = 100_000
"""Parts of a design: twenty times what the largest measured design has."""

SMALLEST_MESH = 1e-12
"""Diagonal (m) of the smallest mesh: an atom is a hundred times larger, and cubes of its lengths are still numbers."""

# ---- problems

# ---- readers

UNIT_QUATERNION = 1e-6
"""A quaternion whose length is off by more than this was not meant as a rotation."""

PARALLEL_AXES = 1e-6
"""Sine of the angle between the two axes of a universal joint below which they are one."""

SYMMETRIC = 1e-9
"""Relative difference up to which the two halves of an inertia are alike: what twelve printed digits lose."""

OUTPUTS = 1_000_000
"""Output times of a run: more would fill the memory before anything is solved."""

VALUE_LENGTH = 60
"""Characters of a wrong value that a message shows."""

# ---- files

HASHED_AT_ONCE = 8
"""Mesh files that are hashed at the same time: more gain nothing on one disk."""

# ---- without_manifest

SMALLEST_ASSEMBLY = 1e-3
"""Diagonal (m) below which a unit is doubted."""

LARGEST_ASSEMBLY = 100.0
"""Diagonal (m) above which a unit is doubted."""

MISTAKEN_METRES = 20.0
"""Diagonal (m) from which on metres are doubted: machines of that size are drawn in mm, and in mm it is 20 mm."""

USUAL_ASSEMBLY = (0.01, 10.0)
"""Diagonals (m) between which another unit is proposed."""

# ---- meshes.weld, meshes.health, meshes.bodies

EPS32 = 2.0**-23
"""Relative step of single precision: no mesh is taken to be known better than that, at its own size."""

WELD_SHARE = 1e-6
"""Welding distance in diagonals of the mesh, where none is stated: ten roundings of single precision."""

SAMPLED_CROWDS = 500
"""Vertices whose surroundings are counted before they are welded."""

CROWD = 50
"""Mean number of others within the welding distance of a vertex, above which a mesh would collapse."""

FLAT = 1e-9
"""A solid thinner than this share of its size has no volume."""

SLIVER = 1e-24
"""Squared altitude of a degenerate facet, in squares of its longest side."""

INSIDE = 0.5
"""Winding number above which a point lies in a shell: it is 1 inside and 0 outside."""

WELD_STEPS = 2.0
"""The same in steps of the last place of the largest coordinate, where that is more: copies of one corner that were
rounded apart differ by one in each direction."""

FAR = 8.0
"""A mesh whose middle lies this many of its diagonals from the origin of its file, along one axis, is moved to its own:
nearer ones lose no more than four bits, of the 29 that doubles have more than single precision."""

# ---- meshes.blocks

BLOCK_BYTES = 1 << 18
"""Bytes of a text that are taken apart at a time: where each line is a letter they take 40 MB then."""

# ---- meshes.digits

LARGE_COORDINATES = 0.1
"""Share of the largest coordinate from which on a coordinate is as coarse as it: one decimal digit."""

DIGITS_READ = 2000
"""Coordinates of a text whose digits are looked at."""

DIGITS_LEAST = 5
"""Digits from which on the largest coordinates can have been cut: no writer keeps fewer, and parts of whole or half
millimetres, up to some metres, have fewer."""

LAST_DIGIT_USED = 0.5
"""Share of the coordinates that use the last digit, above which it is where they were rounded: nine in ten of rounded
numbers do."""

# ---- meshes.polygons, meshes.obj

NO_TRIANGLE = 1e-9
"""Share of a polygon's area below which a triangle is no triangle: a fan with such ones is not taken."""

CUT_CORNERS = 10_000
"""Corners of a concave polygon at most: cutting takes time as their square, 0.8 s for one of so many that crosses
itself, 2.1 s for one of 16,000. Convex ones are fans, and may have any number."""

FACE_BYTES = 4 * 1024 * 1024
"""Of one line of an OBJ that states a vertex or a face: a million corners. Each takes sixty bytes while it is read."""

CUT_AREA = 1e-6
"""Share of a polygon's area that its triangles may miss or have twice."""

FAULTS_KEPT = 1000
"""Faults of one mesh file that are kept, to find those of the first lines among them; a file with more is read no
further."""

FAULTS_SHOWN = 10
"""Faults of one mesh file that are listed, at most."""

# ---- descriptions

XML_BYTES = 64 * 1024 * 1024
"""Largest XML text that is read: descriptions of robots with a thousand links have a tenth of it."""
XML_DEPTH = 255
"""Elements in each other that are read: bodies of MJCF in a row have one each."""

PACKAGE_LEVELS = 4
"""Folders, from that of a description upwards, in which its package is looked for where nothing names it."""
WORKSPACE_LEVELS = 4
"""Folders below the `src` of a workspace in which packages are looked for: `src/group/repository/package`, and one."""
NAME_BYTES = 255
"""Of the name of a file, or of a folder: the most that file systems take."""
PACKAGE_BYTES = 64 * 1024
"""Of a package.xml, that are searched for its name, which stands near the beginning."""

SHEAR = 1e-5
"""Cosine between the axes of a scaled or placed mesh up to which they are at right angles: ten roundings of single
precision, times ten for chains of nodes; quaternions are often printed with six digits."""

FITTED_FLAT = 1e-6
"""Thickness of a mesh over its length below which no primitive is fitted to it: MuJoCo refuses such sizes."""

QUARTER_TURN = 1e-11
"""Quarter turns by which an angle may miss a whole one and be taken for it: what eleven printed digits lose. The pose
that "1.5708" states is kept as it is: it differs by more than forward kinematics is compared to."""

SDF_MODELS = 2000
"""Models of an SDF, included ones too, beyond which no include is read: files that include each other twice, thirty
deep, never end."""

INCLUDES = 32
"""Files in files in files that a description may include: more are a loop that no check of names has seen."""

REPLICAS_MOST = 20_000
"""Elements that `<replicate>` makes, at most: what is made of more are ropes and grains, not machines."""

ATTACHED_DEEP = 16
"""Models in models in models that `<attach>` of an MJCF may name: arms have hands, and hands have fingers."""

ATTACHED_MOST = 20_000
"""Bodies that `<attach>` makes, at most, as for `<replicate>`: a few files that attach each other twice make 2ⁿ."""

PRIMITIVES_KEPT = 256
"""Meshes of primitive solids that are kept for parts of the same shape: a sphere takes 0.1 s to make."""

ROUND_FACETS = 96
"""Facets round a primitive cylinder, sphere or capsule: its vertices are exact, a fit of them gives the exact radius,
and its volume is 0.07 % too small."""

XACRO_FILES = 500
"""Files of a package that are looked through for the names of others, at most."""

NO_BOUND = 1e9
"""rad, m, N·m, N from which on a limit says that there is none: formats that want a limit get numbers such as this, and
files of Gazebo have 1e16. The circumference of the earth is 4e7 m."""

LOOP_GAP = 1e-4
"""Metres, and radians times ten, by which the two ends of a loop that an MJCF closes may miss each other in its pose:
sites are printed to four or more digits. What is further apart is closed in another pose than that of the meshes."""

AXIS_LENGTH = 1e-9
"""Length of a joint's axis below which it is none: axes are unit vectors, up to digits."""

# ---- scenes

SCENE_TEXT_BYTES = 64 * 1024 * 1024
"""Largest JSON of a glTF: 10,000 nodes have a tenth of it, and what is parsed takes ten times as much memory."""

SCENE_XML_BYTES = 1 << 29
"""Largest XML of a 3MF or DAE, unpacked: ten million facets, which take ten times as much memory."""

SCENE_DEEP = 64
"""Nodes of a scene in each other: twice what sub-assemblies may have, for each may have a frame of its own."""

SCENE_NODES = 400_000
"""Nodes that a scene places, counted each time that they are: four for each of the parts that a design may have."""

UNSCALED = 1e-5
"""Relative difference up to which a scale is 1, as rotations in single precision have it."""

# ---- scenes.step

STEP_BYTES = 1 << 30
"""Largest STEP file that is read: the largest public ones have a quarter of it, and OpenCASCADE takes twenty times as
much memory."""

STEP_END = 4096
"""Bytes at either end of a STEP file in which its first and last keyword stand: comments and blanks may be around."""

XACRO_SECONDS = 20
"""Seconds of processor time that the expansion of a xacro file may take: robots take one or two, and macros that call
each other twice, thirty deep, never end."""

XACRO_MEMORY = 4 << 30
"""Bytes of memory that it may take, which an expression can ask for with a few letters; robots take some MB."""

STEP_MEMORY = 12 << 30
"""Bytes of memory that the tessellation of a STEP file may take: beyond, it fails with a message, not the machine."""

STEP_TURN = 0.1
"""Largest angle (rad) between neighbouring facets of one surface: 63 facets round a circle, which are 0.12 % of its
radius from it; fits of such are exact to their vertices."""

STEP_EDGES = 0.005
"""Largest distance of facets from surfaces, as a share of the size of edges: not a length, for what is fine for a watch
takes all memory for a ship (a ball of 10 m, at 0.01 mm, more than 20 GB)."""

SOLID_DEVIATION = 1e-3
"""Deviation of facets of solids that a program holds, in diagonals: `STEP_TURN` decides for what is round."""

STEP_STATED_TURN = 0.25
"""As STEP_TURN, where a deviation is stated: still 25 facets round a circle, for 12 are as few as fits know a cylinder
by."""

# ---- descriptions.coverage, readers.described

UNCOVERED_DEPTH = 0.01
"""Share of a link's size by which its visual may reach out of the collision geometry and counts as covered: facets of
primitives and of simplified meshes."""

SIBLINGS_MOST = 300
"""Files of a package that are looked through for the names of meshes, at most."""

ENTRIES_MOST = 20_000
"""Files and folders that are looked at for these, at most: about a second. The largest public package tried has 1,453;
what is more is a home folder that holds a description."""

SIBLING_BYTES = 4 * 1024 * 1024
"""Of each of these files, at most."""

COVERED_FACETS = 2000
"""Facets of a visual mesh that are held against the collision geometry, about: of larger ones every second, third, …"""

# ---- manifests that are written

WIDTH = 100
"""Columns of comments."""

NOISE = 2e-5
"""Components of a proposed axis or point below this share of the largest are written as zero: 0.001°, or 6 µm at 0.3 m,
is the rounding of meshes in float32 far from the origin, and nothing that is meant."""
ROUNDED = 1e-12
"""Coordinates of a proposed point below this share of the greatest of all meshes are the rounding of doubles."""
COUPLED_MOST = 16
"""Joints of one stated coupling: a compound planetary train has at most as many; each is a column of its row."""

ROWS_MOST = 10_000
"""Rows of a law that is written in the manifest; longer ones are CSV files."""
