"""What is drawn: packed meshes, freedoms, curves, pictures."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from importlib.resources import files

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from support import linkages
from support.devices import Z
from support.places import FIXTURES
from support.png import pixels

from kinform import stages
from kinform.reports.page import Scene
from kinform.reports.page.canvas import layer, nearness, over, paint
from kinform.reports.page.figures import Figure
from kinform.reports.page.freedoms import freedom_motions
from kinform.reports.page.meshes import shape_of, shape_of_facets
from kinform.reports.page.packing import Blob, quantised, restored
from kinform.reports.page.pictures import Artist
from kinform.reports.page.plots import Plot, Series, plot_svg
from kinform.reports.page.raster import View, png, rasterise

VIEWER = files("kinform.reports.page").joinpath("assets", "viewer")


def functional(tmp_path, joints):
    path = tmp_path / "m.toml"
    path.write_text(linkages.manifest(joints))
    return stages.joints(stages.contacts(stages.import_(path))).kinematics


# ---- packing


def unpacked_by_the_viewer(blob, calls):
    """What the viewer's own functions make of the bytes; each call is an expression of `blob`."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node, to run the viewer's functions")
    program = (
        VIEWER.joinpath("2-data.js").read_text(encoding="utf-8")
        + f"""
    const blob = require("zlib").inflateSync(Buffer.from({json.dumps(blob.text())}, "base64"));
    console.log(JSON.stringify([{", ".join(f"Array.from({call})" for call in calls)}]));"""
    )
    ran = subprocess.run([node, "-"], input=program, capture_output=True, text=True, check=True, timeout=60)
    return [np.array(values) for values in json.loads(ran.stdout)]


def test_the_viewer_unpacks_what_was_packed():
    rng = np.random.default_rng(7)
    columns = rng.integers(0, 65536, (50, 7))
    large = np.arange(70_000)[:, None] % 65536
    faces = np.array([[0, 1, 2], [2, 1, 3], [3, 0, 4], [4, 5, 6]])
    far = np.concatenate([np.arange(69_999).reshape(-1, 3), [[0, 69_998, 69_999]]])
    lines = np.array([[0, 4], [3, 70_000], [65_535, 65_536]])
    blob = Blob()
    at = [blob.columns(columns), blob.columns(large), blob.triangles(faces), blob.triangles(far)]
    at.append(blob.columns(np.column_stack([lines & 0xFFFF, lines >> 16])))
    back = unpacked_by_the_viewer(
        blob,
        [
            f"columnsOf(blob, {at[0]}, 50, 7)", f"columnsOf(blob, {at[1]}, 70000, 1)",
            f"trianglesOf(blob, {at[2]}, 4)", f"trianglesOf(blob, {at[3]}, {len(far)})", f"linesOf(blob, {at[4]}, 3)",
        ],
    )  # fmt: skip
    for found, packed in zip(back, (columns, large, faces, far, lines), strict=True):
        assert (found == packed.ravel()).all()


@given(st.lists(st.tuples(*[st.floats(-1e3, 1e3)] * 3), min_size=1, max_size=30))
@settings(max_examples=30, deadline=None)
def test_places_survive_to_half_a_step_of_their_box(places):
    points = np.array(places)
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    error = np.abs(restored(quantised(points, low, size), low, size) - points)
    assert (error <= 0.5001 * size / 65535 + 1e-12).all()


def test_a_shape_has_the_facets_of_its_mesh_and_lines_where_faces_meet():
    design = stages.contacts(stages.import_(FIXTURES / "pairs" / "planar_block" / "planar_block.toml"))
    for part in design.assembly.parts:
        shape = shape_of(part.mesh, design.surfaces[part.mesh.digest])
        assert np.array_equal(shape.vertices[shape.faces], part.mesh.vertices[part.mesh.faces])
        first = np.unique(shape.faces.ravel(), return_index=True)[1]
        assert (np.diff(first) > 0).all()
    assert len(design.assembly.part("block").mesh.faces) == 12
    block = shape_of(design.assembly.part("block").mesh, None)
    ends = {frozenset(map(tuple, np.round(block.vertices[line], 9))) for line in block.lines}
    assert len(ends) == 12
    assert np.abs(np.abs(block.normals).max(axis=1) - 1.0).max() < 1e-12


# ---- freedoms


def test_a_freedom_of_a_loop_moves_every_link_and_keeps_every_pin_together(tmp_path):
    kinematics = functional(tmp_path, linkages.four_bar())
    (showing,) = freedom_motions(kinematics, 4.0)
    names = [body.name for body in kinematics.bodies]
    assert len(showing.bodies) == 3
    assert showing.note == ""
    for joint in kinematics.joints:
        a, b = (showing.poses[:, names.index(name)] for name in joint.bodies)
        pin = np.append(joint.point, 1.0)
        assert np.abs(a @ pin - b @ pin).max() < 1e-4
        assert np.abs(a[:, :3, :3] @ Z - b[:, :3, :3] @ Z).max() < 1e-4
    crank = showing.poses[:, names.index("base")]
    assert np.abs(crank - np.eye(4)).max() == 0.0
    assert np.abs(showing.poses - np.eye(4)).max() > 0.2


def test_each_freedom_of_a_chain_is_one_joint_and_goes_both_ways(derive_design):
    design = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    kinematics = design.kinematics
    shown = freedom_motions(kinematics, 0.2)
    assert sorted(s.driver for s in shown) == sorted(joint.name for joint in kinematics.joints)
    names = [body.name for body in kinematics.bodies]
    for showing in shown:
        assert np.abs(showing.poses[len(showing.poses) // 2] - np.eye(4)).max() < 1e-12
        for joint in kinematics.joints:
            a, b = (showing.poses[:, names.index(name)] for name in joint.bodies)
            between = np.linalg.inv(a) @ b
            turn = np.einsum("nij,i,j->n", between[:, :3, :3], *_across(joint.axis))
            if joint.name == showing.driver:
                assert np.ptp(turn) > 0.9
            else:
                assert np.abs(between - np.eye(4)).max() < 1e-9


def _across(axis):
    u = np.cross(axis, [0.3, 0.5, 0.8])
    u /= np.linalg.norm(u)
    return np.cross(axis, u), u


# ---- curves


def _heights(svg, kind):
    return [float(y) for y in re.findall(rf'class="{kind}"[^>]* y1="([-\d.]+)"', svg)]


def test_limits_stand_at_their_value_between_the_ticks():
    time = np.linspace(0.0, 2.0, 50)
    svg = plot_svg(
        Plot("yaw", "°", (Series("", 10 * np.sin(time)),), (("required limit", -20.0), ("required limit", 15.0))), time
    )
    ticks = [float(t) for t in re.findall(r'text-anchor="end">([-\d.]+)</text>', svg)]
    grid = _heights(svg, "grid")
    slope = (grid[-1] - grid[0]) / (ticks[len(grid) - 1] - ticks[0])
    expected = [grid[0] + slope * (limit - ticks[0]) for limit in (-20.0, 15.0)]
    assert _heights(svg, "limit") == pytest.approx(expected, abs=0.11)


def test_a_long_curve_is_thinned_but_keeps_its_peaks_and_its_gaps():
    values = np.zeros(20_000)
    values[12_345], values[777] = 3.0, -2.0
    values[15_000:15_200] = np.nan
    time = np.linspace(0.0, 1.0, len(values))
    path = re.search(r'class="curve curve-0" d="([^"]+)"', plot_svg(Plot("x", "N", (Series("", values),)), time))[1]
    heights = [float(y) for y in re.findall(r" ([\d.]+)", path)]
    assert len(heights) < 1000
    flat = max(set(heights), key=heights.count)
    assert min(heights) < flat < max(heights)
    assert (flat - min(heights)) / (max(heights) - flat) == pytest.approx(1.5, rel=0.02)
    assert path.count("M") == 2


# ---- pictures


def test_a_png_holds_its_pixels():
    image = np.random.default_rng(1).integers(0, 256, (13, 17, 4), dtype=np.uint8)
    assert (pixels(png(image)) == image).all()


def test_triangles_cover_their_area_and_the_nearer_one_hides_the_other():
    view = View(np.zeros(3), 1.0, 200, 150)
    square = np.array([[10, 10], [110, 10], [110, 90], [10, 90]], float)
    corners = np.concatenate([square, np.full((4, 1), 1.0)], axis=1)[[[0, 1, 2], [0, 2, 3]]]
    small = np.array([[[30, 30, 2], [70, 30, 2], [30, 70, 2]]], float)
    buffers = rasterise(view, np.concatenate([corners, small]))
    assert (buffers.facet >= 0).sum() == 100 * 80
    assert (buffers.facet == 2).sum() == pytest.approx(800, abs=41)
    assert buffers.near[50, 100] == pytest.approx(1.0, abs=1e-6)
    assert buffers.near[35, 35] == pytest.approx(2.0, abs=1e-6)
    behind = rasterise(view, np.concatenate([corners, small - [0, 0, 1.5]]))
    assert not (behind.facet == 2).any()


def test_a_slanted_triangle_is_as_near_as_its_plane():
    view = View(np.zeros(3), 1.0, 60, 60)
    corners = np.array([[[0, 0, 0], [60, 0, 6], [0, 60, 3]]], float)
    buffers = rasterise(view, corners)
    rows, columns = np.nonzero(buffers.facet == 0)
    plane = 0.1 * (columns + 0.5) + 0.05 * (rows + 0.5)
    assert len(rows) == pytest.approx(1800, abs=61)
    assert np.abs(buffers.near[rows, columns] - plane).max() < 1e-5


def test_a_finding_is_shown_in_red_and_the_overview_of_a_sound_design_is_not(derive_design):
    def red(image):
        r, g, b = (image[..., k].astype(int) for k in range(3))
        return ((r > 90) & (r > 2.2 * g) & (r > 2.2 * b) & (b > 0.6 * g) & (image[..., 3] > 200)).sum()

    design = derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml")
    image = pixels(Artist(Scene(design)).finding(0))
    assert image.shape == (320, 480, 4)
    assert red(image) > 100
    assert 0.05 < (image[..., 3] > 0).mean() < 0.95
    sound = pixels(Artist(Scene(derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml"))).overview())
    assert red(sound) == 0


class TestFigures:
    """Shapes that are drawn once for all pictures."""

    @staticmethod
    def ball(scale=1.0):
        solid = trimesh.creation.icosphere(subdivisions=4, radius=0.01 * scale)
        return Figure(shape_of_facets(np.asarray(solid.triangles)), np.eye(4), closed=True)

    @staticmethod
    def view(scale, x=0.0, y=0.0):
        return View(np.array([x, y, 0.0]), scale, 200, 160)

    @pytest.mark.parametrize("finest", [0.0, 9_000.0, 23_000.0])
    def test_a_ball_is_as_near_as_a_ball_whatever_it_was_drawn_for(self, finest):
        figure = self.ball()
        if finest:
            figure.expect(self.view(finest))
        view = self.view(7_000.0, x=0.002)
        for column, row in ((100, 80), (60, 90), (110, 40), (85, 130)):
            x = 0.002 + (column + 0.5 - 100) / 7_000.0
            y = -(row + 0.5 - 80) / 7_000.0
            assert nearness(view, figure, column, row) == pytest.approx(np.sqrt(1e-4 - x * x - y * y), abs=2e-4)
        assert nearness(view, figure, 190, 80) == -np.inf

    def test_what_is_too_large_is_drawn_where_it_is_looked_at(self):
        figure, small = self.ball(1000.0), self.ball()
        view = self.view(20_000.0, x=0.5, y=-0.3)  # of ten metres, eight millimetres
        assert nearness(view, figure, 100, 80) == pytest.approx(np.sqrt(100.0 - 0.34), abs=0.02)
        assert figure.samples(view).near.shape[0] < 400
        assert small.samples(self.view(12_000.0)).near.shape[0] > 239

    def test_a_picture_of_a_corner_of_it_makes_no_other_finer(self):
        figure, whole = self.ball(), self.view(4_000.0)
        figure.expect(self.view(90_000.0, x=0.009))  # of 20 mm, two
        assert figure.samples(whole).scale == whole.scale
        corner = figure.samples(self.view(90_000.0, x=0.009)).near
        assert corner.size <= 201 * 161
        figure.expect(self.view(9_000.0))
        assert figure.samples(whole).scale == 9_000.0

    def test_a_layer_over_a_part_of_a_picture_is_the_layer_over_the_whole(self):
        figure, other, view = self.ball(), self.ball(0.3), self.view(4_000.0)
        below = layer(view, [(figure, (0.2, 0.4, 0.6))])
        whole = over(layer(view, [(other, (1.0, 0.0, 0.0))]), below, 0.5)
        painted = below.copy()
        paint(painted, view, [(other, (1.0, 0.0, 0.0))], 0.5)
        seen = whole[..., 3] > 0.0
        assert np.abs(whole - painted)[seen].max() < 1e-6
        assert seen.sum() == pytest.approx(np.pi * 40.0**2, rel=0.02)
