"""Tables and sentences of docs/jamming.md have the numbers of validation/jamming."""

import numpy as np

from validation.jamming.documented import VIBRATIONS, per_contact
from validation.jamming.vibrations import summarize


def test_summary_of_the_modes_is_that_of_the_packings():
    for written, found in zip(VIBRATIONS["summary"], summarize(VIBRATIONS["rows"]), strict=True):
        for name, number in found.items():
            if isinstance(number, float) and not np.isfinite(number):
                assert written[name] is None, name
            else:
                assert written[name] == number or np.isclose(written[name], number, rtol=1e-9), name


def test_the_plateau_begins_in_proportion_to_the_contacts():
    """omega* ~ z - z_iso (Wyart, Nagel, Witten 2005), over a decade of z - z_iso."""
    for law, packings in (("disk", 4), ("radical", 3)):
        found = per_contact(law)
        assert len(found) >= packings
        assert max(found) < 1.5 * min(found)


def test_all_packings_are_at_rest_and_stable():
    assert all(row["residual"] < 1e-5 and row["unstable"] == 0 for row in VIBRATIONS["rows"])
