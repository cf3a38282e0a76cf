"""Ranks without particles, of every law, fix and compute: clusters leave some and reach others."""

import pytest
from every_style import SCENES, assert_same, told
from parallel import finished


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    folder = tmp_path_factory.mktemp("one")
    return told(lambda script: finished(1, script, folder), folder)


@pytest.mark.parametrize("ranks", [2, pytest.param(4, marks=pytest.mark.slow)])
def test_as_on_one_rank(ranks, one_rank, tmp_path):
    """Balanced contacts are known to their tolerance, a minimum to the square of forces left."""
    found = told(lambda script: finished(ranks, script, tmp_path), tmp_path)
    assert len(one_rank) == 3 * len(SCENES)
    assert_same(found, one_rank)
