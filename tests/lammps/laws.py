"""The contact laws that tests run with. A new one is a line here."""

import pytest

BALANCES = {
    "balanced": "deformable/ring contact balanced",
    "curved": "deformable/ring contact curved",
}
RING_LAWS = {"radical": "deformable/ring contact radical"} | BALANCES
LAWS = {"sector": "deformable/sector"} | RING_LAWS
DIRECT = tuple(law for law in LAWS if law not in BALANCES)  # their contacts need no solver
# forces are balanced as far as rounding lets them; beyond the model curved lines take their time
EXACT = LAWS | {
    law: f"{LAWS[law]} balance 1e-12 {most}" for law, most in (("balanced", 100), ("curved", 1000))
}
RADICAL, BALANCED, CURVED = RING_LAWS.values()

laws = pytest.mark.parametrize("law", LAWS)
ring_laws = pytest.mark.parametrize("law", RING_LAWS)
direct_laws = pytest.mark.parametrize("law", DIRECT)
# where the formula of a law does not matter: contacts from neighbor lists, and balanced ones
two_laws = pytest.mark.parametrize("law", ["radical", "balanced"])
straight_laws = pytest.mark.parametrize("law", [law for law in LAWS if law != "curved"])
balanced_laws = pytest.mark.parametrize("law", BALANCES)
