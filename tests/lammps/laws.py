"""The ring laws with rings, droplets and both, for what all have in common."""

import pytest
from tense import BALANCED, RADICAL, TILTED, droplets, tense_mixture
from test_soft_rings import mixture

STYLES = {"radical": RADICAL, "balanced": BALANCED, "tilted": TILTED}
EXACT = {
    law: style if law == "radical" else f"{style} balance 1e-12 100"
    for law, style in STYLES.items()
}
laws = pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
exact_laws = pytest.mark.parametrize("style", EXACT.values(), ids=EXACT)


def rings(case, style, **options):
    """Of eight stiffnesses."""
    return mixture(case, style, **options)[0]


def all_species(case, style, **options):
    """Droplets, bubbles and rings."""
    return tense_mixture(case, style, **options)[0]


KINDS = {"rings": rings, "droplets": droplets, "all species": all_species}
kinds = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
