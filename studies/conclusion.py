"""The verdict in words: who kept the wheels on the ground since the impact, and at which cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cosim.scenario import Scenario

from .metrics import Metric


def conclusion(columns: Mapping[str, list[Metric]]) -> list[str]:
    """Return a sentence per variant, the one that loses contact for the shortest time first; empty without contacts."""
    values = {variant: {m.key: m.value for m in metrics} for variant, metrics in columns.items()}
    judged = {variant: v for variant, v in values.items() if v.get("front_off") is not None}
    order = sorted(judged, key=lambda variant: (_off(judged[variant]), judged[variant].get("actuator_energy") or 0.0))
    return [f"{variant} {_contact(judged[variant])}, {_cost(judged[variant])}." for variant in order]


def _off(v: Mapping[str, float | None]) -> float:
    return (v.get("front_off") or 0.0) + (v.get("rear_off") or 0.0)


def _contact(v: Mapping[str, float | None]) -> str:
    if not _off(v):
        return "keeps all wheels on the ground"
    parts = [
        f"{_round(v[f'{axle}_off'])} ms at the {axle} ({v[f'{axle}_rebounds']:.0f} rebounds)"
        for axle in ("front", "rear")
        if v.get(f"{axle}_off")
    ]
    return "has a wheel off the ground for " + " and ".join(parts)


def _cost(v: Mapping[str, float | None]) -> str:
    demand, saturated, energy = v.get("demand_peak"), v.get("saturated"), v.get("actuator_energy")
    if not demand and not energy:
        return "without traction"
    parts = [f"up to {_round(demand)} N asked of a wheel"] if demand else []
    parts += [f"{_round(energy)} J of actuator work"] if energy else []
    parts += [f"a wheel at its friction limit {saturated:.2g} % of the time"] if saturated else []
    return "with " + ", ".join(parts)


def _round(value: float | None) -> str:
    """Return three significant digits, without an exponent where a reader would not expect one."""
    return f"{float(f'{value:.3g}'):g}"


def heading(scenarios: Sequence[Scenario]) -> str:
    """Return what a comparison of runs of these scenarios is called."""
    names = list(dict.fromkeys(s.name for s in scenarios))
    return scenarios[0].title if len(names) == 1 else f"Runs of {', '.join(names)}"


def mixed(scenarios: Sequence[Scenario]) -> tuple[str, ...]:
    """Return what is to be said if these scenarios are not one: their obstacles and starts differ, too."""
    names = list(dict.fromkeys(s.name for s in scenarios))
    if len(names) < 2:
        return ()
    made = ", ".join(f"{s.variant} of {s.name}" for s in scenarios)
    return (f"these are runs of different scenarios ({made}): what differs is not only what is compared",)
