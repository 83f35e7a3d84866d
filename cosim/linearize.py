"""A component near a point as a linear system: x' = A x + B u, y = C x + D u, named and ready for python-control."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .component import Component
from .errors import DeclarationError
from .instance import Instance

if TYPE_CHECKING:
    import control


def linearize(subject: Component | Instance) -> control.StateSpace:
    """Return the derivatives of an instance's equations at the point where it is, exact (no differences).

    A component is taken at its start values.  Signals are deviations from that point; they are called like the scalars
    of the ports, ``F`` or ``gap[2]``.  Raises DeclarationError for a component without derivatives of its states.
    """
    import control

    instance = subject.instance() if isinstance(subject, Component) else subject
    rates = [name for name in instance.variables if name.startswith("der(")]
    states = [instance.variable(rate[4:-1]) for rate in rates]
    held = [name for name, v in instance.variables.items() if v.causality == "local" and name not in rates]
    if len(held) != len(states) or not instance.can.directional_derivatives:
        raise DeclarationError(
            f"{instance.name} cannot be linearised: it does not declare the derivatives of its states"
        )
    knowns = [*states, *instance.inputs]
    unknowns = [*rates, *(v.name for v in instance.outputs)]
    columns = np.eye(sum(v.size for v in knowns))
    names = [v.name for v in knowns]
    jacobian = np.array([instance.directional_derivative(unknowns, names, seed) for seed in columns]).T
    n = sum(v.size for v in states)
    return control.StateSpace(
        jacobian[:n, :n], jacobian[:n, n:], jacobian[n:, :n], jacobian[n:, n:],
        states=[label for v in states for label in v.labels()],
        inputs=[label for v in instance.inputs for label in v.labels()],
        outputs=[label for v in instance.outputs for label in v.labels()],
        name=instance.name,
    )  # fmt: skip
