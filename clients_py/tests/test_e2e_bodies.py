"""Bodies that hair meets, on a real daemon: what is sent comes back, what is bad is refused by
name, and moving bodies go where the stream says."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

import mane
import mane.aio
from conftest import make_guides, shake


def box(size: float = 0.1, sides: int = 6) -> mane.Mesh:
    """A closed cube, or the first `sides` of it."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size
    squares = [
        (0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3),
    ]  # fmt: skip
    triangles = [t for a, b, c, d in squares[:sides] for t in ((a, b, c), (a, c, d))]
    return mane.Mesh(corners, triangles)


def ball(name: str, **changes) -> mane.Body:
    return mane.Body(name, mane.CapsuleBody((0, 0, 0), (0, 0, 0), 0.05), **changes)


@pytest.fixture
def met(client):
    """Five guides that meet a fixed prop and a moving hand."""
    groom = client.create_groom(
        make_guides(5), bodies=[mane.Body("prop", box()), ball("hand", moving=True)]
    )
    yield groom
    client.delete_groom(groom)


def passing(count: int = 20) -> list[mane.Pose]:
    """Poses of a moving head that a hand passes, named in every other one."""
    poses = []
    for k, pose in enumerate(shake(count / 60).poses()):
        hand = {"hand": mane.Pose(position=(0.3 - 0.02 * k, 0.1, 0))} if k % 2 else {}
        poses.append(mane.Pose(pose.time_s, pose.position, pose.orientation, bodies=hand))
    return poses


def test_every_field_of_a_body_comes_back(client):
    sent = [
        mane.Body("ear", mane.EllipsoidBody((0.02, 0.03, 0.01)), material="silk"),
        mane.Body(
            "arm",
            mane.CapsuleBody((0, 0, 0), (0, -0.3, 0.1), 0.04),
            friction=0.7,
            friction_anisotropy=0.2,
            moving=True,
            pose=mane.Pose(position=(0.2, -0.1, 0), orientation=(0, 1, 0, 0)),
        ),
        mane.Body("collar", mane.mesh.mannequin()),
    ]
    contact = mane.ScalpContact("skin", friction_anisotropy=0.1)
    scalp = mane.Ellipsoid((0.08, 0.11, 0.1))
    groom = client.create_groom(
        make_guides(2), scalp=scalp, scalp_contact=contact, bodies=sent, display_name="bodies"
    )
    listed = next(made for made in client.list_grooms() if made.name == groom.name)
    assert listed.body_count == groom.body_count == 3 and not listed.body_summaries
    ear, arm, collar = groom.body_summaries
    assert (ear.name, ear.shape, ear.moving, ear.mesh) == ("ear", "ellipsoid", False, None)
    assert (arm.name, arm.shape, arm.moving) == ("arm", "capsule", True)
    assert collar.mesh.triangles == len(sent[2].shape.triangles) and not collar.mesh.inverted
    assert 0 < collar.mesh.max_error_m < 1e-3 and collar.mesh.bytes > 0
    assert (groom.scalp_contact.friction, groom.scalp_contact.friction_anisotropy) == (0.4, 0.1)

    whole = client.export_groom(groom)
    assert [body.name for body in whole.bodies] == ["ear", "arm", "collar"]
    assert whole.bodies[0].friction == 0.2 and whole.bodies[1].friction == 0.7
    np.testing.assert_array_equal(whole.bodies[0].shape.radii_m, sent[0].shape.radii_m)
    np.testing.assert_array_equal(whole.bodies[1].shape.b, sent[1].shape.b)
    np.testing.assert_array_equal(whole.bodies[1].pose.position, sent[1].pose.position)
    np.testing.assert_array_equal(whole.bodies[1].pose.orientation, sent[1].pose.orientation)
    np.testing.assert_array_equal(whole.bodies[2].shape.vertices, sent[2].shape.vertices)
    np.testing.assert_array_equal(whole.bodies[2].shape.triangles, sent[2].shape.triangles)

    again = client.create_groom(
        whole.guides, scalp=whole.scalp, scalp_contact=whole.scalp_contact, bodies=whole.bodies,
        display_name="bodies",
    )  # fmt: skip
    assert again.etag == groom.etag and again.body_summaries == groom.body_summaries
    bare = client.create_groom(whole.guides, scalp=scalp, display_name="bodies")
    assert bare.etag != groom.etag and bare.scalp_contact is None
    for made in (groom, again, bare):
        client.delete_groom(made)


@pytest.mark.parametrize(
    ("body", "field", "says"),
    [
        (mane.Body("tub", box(sides=4)), "bodies[1].mesh.triangles", '"tub"'),
        (mane.Body("void", mane.Mesh([], [])), "bodies[1].mesh.vertices", '"void"'),
        (mane.Body("huge", box(500)), "bodies[1].mesh.vertices", '"huge"'),
        (ball("No Name"), "bodies[1].name", "No Name"),
        (ball("first"), "bodies[1].name", "first"),
        (ball("rough", friction=-1), "bodies[1].friction", "[0, 10]"),
        (mane.Body("flat", mane.EllipsoidBody((1, 0, 1))), "bodies[1].ellipsoid.radii_m.y", "is 0"),
    ],
)
def test_a_bad_body_is_refused_by_name(client, body, field, says):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.create_groom(make_guides(1), bodies=[ball("first"), body])
    assert caught.value.field_violations[0].field == field
    assert says in str(caught.value)


def test_what_this_side_can_see_is_refused_without_a_server():
    with pytest.raises(mane.InvalidArgument, match="vertices"):
        mane.Body("nan", mane.Mesh([(np.nan, 0, 0)] * 3, [(0, 1, 2)]))
    with pytest.raises(mane.InvalidArgument, match="material"):
        ball("odd", material="stone")
    with pytest.raises(mane.InvalidArgument, match="shape"):
        mane.Body("bare", (1, 2, 3))


def test_contact_with_the_scalp_needs_a_scalp(client):
    with pytest.raises(mane.InvalidArgument, match="header.scalp_contact"):
        client.create_groom(make_guides(1), scalp_contact=mane.ScalpContact())


def test_hair_meets_a_scalp_of_triangles_that_bound_a_solid(client):
    with pytest.raises(mane.InvalidArgument, match="the scalp that hair meets") as caught:
        client.create_groom(
            make_guides(1), scalp=box(sides=4), scalp_contact=mane.ScalpContact("skin")
        )
    assert caught.value.field_violations[0].field == "scalp_mesh.triangles"
    open_box = client.create_groom(make_guides(1), scalp=box(sides=4))  # No contact, no demand.
    torn = mane.Mesh(box().vertices, box().triangles[:-1])
    mended = client.create_groom(
        make_guides(1), scalp=torn, scalp_contact=mane.ScalpContact("skin")
    )
    assert mended.scalp_contact.mesh.holes == 1 and mended.scalp_contact.mesh.triangles == 11
    for groom in (open_box, mended):
        client.delete_groom(groom)


def test_wisps_of_all_kinds_of_guides_have_their_radius(client):
    line = np.outer(np.linspace(0, 0.1, 20), (0, -1, 0))
    generate = mane.GuideGeneration("asian_smooth", 3, 0.1, wisp_radius_m=0.012)
    for made in (
        client.create_groom(scalp=mane.Ellipsoid((0.1, 0.1, 0.1)), generate=generate),
        client.create_groom(
            strands=[line], import_options=mane.ImportOptions(wisp_radius_m=0.012)
        ),
    ):
        guides = client.export_groom(made).guides
        assert [guide.wisp_radius_m for guide in guides] == [0.012] * len(guides)
        client.delete_groom(made)


def test_lockstep_with_a_moving_body_is_the_same_bits_every_time_and_in_a_bake(client, met):
    runs = []
    for _ in range(2):
        with client.open_head(met, "lockstep") as head:
            runs.append([frame.positions for frame in head.play(passing())])
    np.testing.assert_array_equal(runs[0], runs[1])
    assert np.isfinite(runs[0]).all()

    motion = shake(0.3)
    hand = mane.Motion(motion.times_s, np.outer(0.3 - motion.times_s, (1, 0, 0)))
    motion = mane.Motion(motion.times_s, motion.positions, motion.orientations, {"hand": hand})
    with client.open_head(met, "lockstep") as head:
        played = [frame.positions for frame in head.play(motion)]
    bake = client.bake(met, motion)
    bake.wait()
    np.testing.assert_array_equal([frame.positions for frame in bake.frames()], played)


def test_a_body_stays_where_it_was_last_named_and_pushes_hair_aside(client, met):
    poses = list(shake(0.5).poses())
    here = {"hand": mane.Pose(position=(0.05, 0.1, 0))}
    far = {"hand": mane.Pose(position=(5, 0, 0))}

    def play(bodies_of) -> np.ndarray:
        with client.open_head(met, "lockstep") as head:
            moving = [
                mane.Pose(pose.time_s, pose.position, pose.orientation, bodies=bodies_of(k))
                for k, pose in enumerate(poses)
            ]
            return np.array([frame.positions for frame in head.play(moving)])

    once = play(lambda k: {} if k else here)
    np.testing.assert_array_equal(once, play(lambda k: here))
    assert np.abs(once - play(lambda k: far)).max() > 0.005


@pytest.mark.parametrize("name", ["hnad", "prop", ""])
def test_a_body_that_does_not_move_cannot_be_placed(client, met, name):
    poses = {"hand": mane.Pose(), name: mane.Pose()}
    with client.open_head(met, "lockstep") as head, pytest.raises(mane.InvalidArgument) as caught:
        head.step(mane.Pose(0.0, bodies=poses))
    assert caught.value.field_violations[0].field == "pose.bodies[1].name"
    assert "hand" in str(caught.value)
    still = mane.Motion([0.0])
    with pytest.raises(mane.InvalidArgument) as caught:
        client.bake(met, mane.Motion([0.0], bodies={"hand": still, name: still}))
    assert caught.value.field_violations[0].field == "motion.bodies[1].name"


def test_a_realtime_head_takes_bodies_and_goes_on(client, met):
    with client.open_head(met, "realtime", rate_hz=120) as head:
        for pose in passing():
            head.push(pose)
        head.teleport(mane.Pose(10.0, bodies={"hand": mane.Pose(position=(1, 0, 0))}))
        frames = head.frames()
        while (frame := next(frames)).time_s < 10:
            pass
        assert np.isfinite(frame.positions).all() and frame.repaired_guides == 0


def test_bodies_reach_the_server_by_asyncio_too(maned, client, met):
    async def talk():
        async with mane.aio.Client(maned.address) as other:
            groom = await other.create_groom(make_guides(5), bodies=[ball("hand", moving=True)])
            async with other.open_head(groom, "lockstep") as head:
                frames = [frame.positions async for frame in head.play(passing())]
            await other.delete_groom(groom)
            return groom, frames

    groom, frames = asyncio.run(talk())
    assert groom.body_summaries[0].moving and len(frames) == 20
