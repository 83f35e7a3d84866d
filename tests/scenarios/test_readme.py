"""The tables of README.md are what fresh runs give."""

import re

import pytest

from studies import readme

# Undamped rebounds amplify rounding; another machine's libm may move a figure by this much, a changed model by more.
SAME = 0.02


@pytest.mark.parametrize("name", readme.TABLES)
def test_a_table_is_what_its_scenario_gives(name: str) -> None:
    match = readme.block(name).search(readme.README.read_text(encoding="utf-8"))
    assert match is not None
    shown, fresh = (text.strip().splitlines() for text in (match[1], readme.table(readme.results(name))))
    assert [cells(line)[0] for line in shown] == [cells(line)[0] for line in fresh]
    assert shown[0] == fresh[0]
    for line, now in zip(shown[2:], fresh[2:], strict=True):
        for before, after in zip(cells(line)[1:], cells(now)[1:], strict=True):
            assert float(before) == pytest.approx(float(after), rel=SAME), line


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
