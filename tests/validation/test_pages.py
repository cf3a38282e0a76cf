"""Tables, sentences and logs of studies and benchmarks follow from the committed measurements."""

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("freud")
pytest.importorskip("networkx")

from validation.documented import STUDIES, check, logs, pages


@pytest.mark.parametrize("study", STUDIES)
def test_pages_follow_from_the_measurements(study: str) -> None:
    for page, (tables, sentences) in pages(study).items():
        check(page, (table() for table in tables), sentences)
    for log, lines in logs(study).items():
        assert log.read_text().splitlines() == list(lines())
