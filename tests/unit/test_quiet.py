"""Warnings are left out in several threads at once, and shown again afterwards."""

from __future__ import annotations

import warnings
from threading import Event, Thread

from cosim.quiet import without


def test_two_threads_leave_the_filters_as_they_were() -> None:
    """The second would begin within the first and end after it."""
    before = list(warnings.filters)
    inside, first_ended = Event(), Event()

    def second() -> None:
        with without(UserWarning):
            inside.set()
            assert first_ended.wait(10)

    thread = Thread(target=second)
    with without(RuntimeWarning):
        thread.start()
        assert not inside.wait(0.2)  # it waits for the first to end
    first_ended.set()
    thread.join(10)
    assert inside.is_set()
    assert warnings.filters == before


def test_others_are_shown() -> None:
    with warnings.catch_warnings(record=True) as shown:
        warnings.simplefilter("always")
        with without(UserWarning, "known"):
            warnings.warn("known and expected", UserWarning, stacklevel=1)
            warnings.warn("unknown", UserWarning, stacklevel=1)
            warnings.warn("known, of another kind", RuntimeWarning, stacklevel=1)
    assert [str(w.message) for w in shown] == ["unknown", "known, of another kind"]
