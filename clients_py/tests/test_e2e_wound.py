"""Wound strands on a real daemon: chosen for hair of many turns, rebuilt as the server has it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import mane
from conftest import make_guide, make_guides, shake
from mane.helix import Strands

SCALP = mane.Ellipsoid((0.08, 0.1, 0.09), cap_angle=1.2)
CURLY = {"natural_twist": 188.0, "natural_curvature_1": 160.0, "natural_curvature_2": 240.0}


@pytest.fixture(params=[("caucasian_curly", 0.3), ("african_fuzzy", 0.1)], ids=["curly", "fuzzy"])
def generated(request, client) -> Iterator[mane.Groom]:
    """Six guides that the server chose the model of."""
    hair_type, length_m = request.param
    generate = mane.GuideGeneration(hair_type, 6, length_m, seed=3)
    groom = client.create_groom(scalp=SCALP, generate=generate)
    yield groom
    client.delete_groom(groom)


@pytest.fixture
def mixed(client) -> Iterator[mane.Groom]:
    """Plain and wound guides in turn."""
    guides = make_guides(3) + [make_guide(model="wound", **CURLY) for _ in range(3)]
    groom = client.create_groom([guides[k] for k in (0, 3, 1, 4, 2, 5)])
    yield groom
    client.delete_groom(groom)


def play(client, groom, **options) -> list[mane.Frame]:
    with client.open_head(groom, "lockstep", points_per_guide=48, **options) as head:
        return list(head.play(shake(0.5)))


def assert_rebuilt_as_sent(client, groom):
    sent = play(client, groom, format="float32")
    rebuilt = play(client, groom, format="generalized")
    guides = client.export_groom(groom).guides
    for one, other in zip(sent, rebuilt, strict=True):
        np.testing.assert_allclose(other.positions, one.positions, atol=2e-5)
        assert one.repaired_guides == other.repaired_guides == 0
        for guide, angles in zip(guides, other.angles, strict=True):
            width = 4 if guide.model == mane.StrandModel.WOUND else 3
            assert angles.shape == (len(guide.resolved_element_lengths_m()), width)
    moved = np.ptp([frame.positions[:, -1] - frame.positions[:, 0] for frame in sent], axis=0)
    assert moved.max() > 0.002  # The hair did swing.


def test_hair_of_many_turns_is_wound_by_itself(client, generated):
    for guide in client.export_groom(generated).guides:
        assert guide.model == mane.StrandModel.WOUND
        lengths = guide.resolved_element_lengths_m()
        turns = np.linalg.norm(guide.resolved_natural(), axis=1) @ lengths / (2 * np.pi)
        assert turns >= 5 and turns > len(lengths) / 2


@pytest.mark.parametrize("model", list(mane.StrandModel))
def test_the_model_that_is_asked_for_is_taken(client, model):
    generate = mane.GuideGeneration("african_fuzzy", 3, 0.1, 8, model=model)
    groom = client.create_groom(scalp=SCALP, generate=generate)
    assert {guide.model for guide in client.export_groom(groom).guides} == {model}
    client.delete_groom(groom)


def test_generated_wound_hair_is_rebuilt_as_it_is_sent(client, generated):
    assert_rebuilt_as_sent(client, generated)


def test_plain_and_wound_hair_is_rebuilt_as_it_is_sent(client, mixed):
    assert_rebuilt_as_sent(client, mixed)


def test_rest_shapes_fit_their_coordinates(client, mixed):
    guides = client.export_groom(mixed).guides
    rest = client.rest_shape(mixed, points_per_guide=30)
    assert [values.shape[1] for values in rest.curvatures] == [3, 4] * 3
    assert np.all(rest.residuals <= 1e-6)
    coordinates = [
        values * guide.resolved_element_lengths_m()[:, None]
        for guide, values in zip(guides, rest.curvatures, strict=True)
    ]
    flat = np.concatenate([x.ravel() for x in coordinates])
    np.testing.assert_allclose(rest.positions, Strands(guides).positions(flat, 30), atol=1e-9)


def test_models_survive_the_way_there_and_back(client, mixed):
    models = [guide.model for guide in client.export_groom(mixed).guides]
    assert models == [mane.StrandModel.SUPER_HELIX, mane.StrandModel.WOUND] * 3


@pytest.mark.parametrize(
    "natural", [{"natural_curvature_1": 0}, {"natural_curvature_1": [20, 20, 0, 20]}]
)
def test_a_wound_guide_without_curvature_is_refused(client, natural):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.create_groom([make_guide(model="wound", **natural)])
    assert caught.value.field_violations[0].field == "guides[0].model"
