"""FMI 3.0 co-simulation FMUs used with event mode: time events, state events, input events and clocks.

The FMU is where its own float time says, which after an early return is up to 1 ns before the tick at which the others
are.
"""

from __future__ import annotations

import pickle
from copy import copy
from ctypes import byref, c_bool, c_double, c_void_p
from typing import Any

from cosim import Advance, StepError
from cosim.clock import NS, tick_at_or_after
from cosim.instance import Update

from .binding import DISCARD, OK, WARNING
from .clock_calls import CLOCK_PROTOTYPES
from .clocks import exact, tick_of
from .event_ports import EVENT, STEP, DiscreteFmu3
from .fmi3 import Fmu3

MAX_UPDATES = 1000  # of the discrete states at one instant
MAX_EVENTS = 100_000  # in one step, where nobody else looks at them
_KEPT = ("at", "active", "_mode", "_next_time", "_next", "_due", "_others", "_waiting", "_pending", "_held")
_PROTOTYPES: dict[str, tuple[Any, ...]] = {
    "fmi3EnterEventMode": (c_void_p,),
    "fmi3EnterStepMode": (c_void_p,),
    "fmi3UpdateDiscreteStates": (c_void_p,) * 7,
    **CLOCK_PROTOTYPES,
}


class EventFmu3(DiscreteFmu3):
    """An instance of an FMI 3.0 FMU, used with event mode."""

    def _begin(self) -> None:
        super()._begin()
        self.at = 0.0  # s, where the FMU is
        self._next_time: float | None = None  # of the FMU's own time event
        self._next: tuple[float, int] | None = None  # of that or a clock, in s and as a tick
        self._due: tuple[str, ...] = ()  # clocks that ticked since event mode was entered

    @staticmethod
    def prototypes() -> dict[str, tuple[Any, ...]]:
        """Return the argument types of the C functions used."""
        return Fmu3.prototypes() | _PROTOTYPES

    # life

    def exit_initialization(self) -> None:
        """End initialisation: the FMU is in event mode, and ``enter_step_mode`` or the first step ends that."""
        self.at = self.time
        for name, period in self.schedule.periods.items():
            self._clocks.set_interval(self.clocks[name], period)
        try:
            self.schedule.begin(exact(self.time))
        except ValueError as error:
            raise StepError(self.name, self.time, str(error)) from None
        super().exit_initialization()
        self._mode = EVENT
        self._held = self.u[self._held_at]

    def reset(self) -> None:
        """Set the FMU back to what it was when it was instantiated."""
        super().reset()
        self._begin()
        self.schedule.due, self.schedule.periods = {}, {}

    def next_event(self) -> int | None:
        """Return the tick by which the FMU must be in event mode again."""
        if self._mode == EVENT or self._pending:
            return tick_at_or_after(self.at)
        return self._next[1] if self._next else None

    def enter_event_mode(self) -> None:
        """Enter event mode; clocks that are due tick."""
        if self._mode == STEP:
            self._call("fmi3EnterEventMode")
        self._mode, self.active = EVENT, frozenset()
        self._due = self.schedule.at(tick_at_or_after(self.at))
        self.tick(self._due)
        self._pending = False

    def update_discrete_states(self) -> Update:
        """Go on to the next instant of the same time."""
        again, terminate, nominals, states, defined = (c_bool() for _ in range(5))
        time = c_double()
        flags = [byref(flag) for flag in (again, terminate, nominals, states, defined)]
        self._call("fmi3UpdateDiscreteStates", *flags, byref(time))
        self.active = frozenset()
        self._next_time = time.value if defined.value else None
        return Update(again.value, terminate.value)

    def enter_step_mode(self) -> None:
        """Learn when clocks tick next, and leave event mode."""
        ticked = [t for name in self._due if (t := self.schedule.due[name]) is not None]
        self.schedule.go_on(max(ticked, default=exact(self.at)), self._due)
        self._call("fmi3EnterStepMode")
        self._mode, self._due, self.active = STEP, (), frozenset()
        self._plan()

    def _plan(self) -> None:
        times = [] if self._next_time is None else [(self._next_time, tick_at_or_after(self._next_time))]
        if (clock := self.schedule.next()) is not None:
            times.append((float(clock), tick_of(clock)))
        self._next = min(times, key=lambda pair: pair[1], default=None)

    # stepping

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        """Advance from tick *start* to *end*, or to an event before it if *early_return*.

        Without it, events before the end are handled on the way.  One at the end waits for ``enter_event_mode``, or is
        the first thing in the next step.
        """
        if self._due_now():
            self._handle()
        if self._polynomials:
            self._polynomials.began = self.at
        for _ in range(MAX_EVENTS):
            scheduled = self._next is not None and self._next[1] <= end
            goal = min(self._next[0], end / NS) if self._next is not None and scheduled else end / NS
            self._flags[:] = [False, False, False]
            if self._advance(goal) == DISCARD:
                return self._discarded("fmi3DoStep", start, end, self._reached.value, early_return)
            reached = min(max(tick_at_or_after(self.at), start + 1), end)
            if self._flags[1]:
                return Advance(tick_at_or_after(self.at), early=self.at < end / NS, terminated=True)
            own = self._flags[0] or (self._next_time is not None and self.at >= self._next_time)
            self._pending = own or (scheduled and self.at >= goal)
            if reached == end and (self._pending or self.at >= end / NS):
                return Advance(end, early=own)
            if self._pending and early_return:
                return Advance(reached, early=True)
            if self._pending:
                self._handle()
        raise StepError(self.name, self.at, f"it has more than {MAX_EVENTS} events in one step")

    def _due_now(self) -> bool:
        if self._mode == EVENT or self._pending:
            return True
        return self._next is not None and self._next[1] <= tick_at_or_after(self.at)

    def _advance(self, goal: float) -> int:
        if not goal > self.at:
            return OK
        status = self._do_step(self._c, self.at, goal - self.at, False, *self._ending)
        self.time = self.at
        if self._polynomials and self._polynomials.failed:
            self._fail("fmi3SetFloat64 within a step", self._polynomials.status)
        if status == DISCARD:
            return status
        if status > WARNING:
            self._fail("fmi3DoStep", status)
        ended = not (self._flags[1] or self._flags[2])
        self.at = goal if ended else self._reached.value
        self.time = self.at
        return OK

    def _handle(self) -> None:
        """Handle an event alone, at an instant at which nobody else looks."""
        self.enter_event_mode()
        for _ in range(MAX_UPDATES):
            self.push()
            self.pull()
            again = self.update_discrete_states().again
            self.pull()
            if not (again or self.active):
                return self.enter_step_mode()
        raise StepError(self.name, self.at, f"its discrete states still change after {MAX_UPDATES} updates")

    # rollback

    def snapshot(self) -> Any:
        """Return the FMU's state and what is known of its events; to be freed by ``forget``."""
        mine = {name: copy(getattr(self, name)) for name in _KEPT}
        return super().snapshot(), mine, dict(self.schedule.due), dict(self.schedule.periods), self.y.copy()

    def restore(self, snapshot: Any) -> None:
        """Go back to a snapshot of this instance."""
        state, mine, due, periods, y = snapshot
        super().restore(state)
        for name, value in mine.items():
            setattr(self, name, copy(value))
        self.schedule.due, self.schedule.periods = dict(due), dict(periods)
        self.y[:] = y

    def forget(self, snapshot: Any) -> None:
        """Free a snapshot."""
        super().forget(snapshot[0])

    def serialize(self, snapshot: Any) -> bytes:
        """Return a snapshot as bytes."""
        return pickle.dumps((super().serialize(snapshot[0]), *snapshot[1:]))

    def deserialize(self, data: bytes) -> Any:
        """Return the snapshot that *data* holds."""
        state, *mine = pickle.loads(data)
        return super().deserialize(state), *mine
