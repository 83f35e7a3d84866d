"""The error of a step as an algorithm estimates it, whichever way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Estimate:
    """Estimated errors of outputs at the end of a step, with what they are measured by; all arrays have one length."""

    labels: tuple[str, ...]
    error: np.ndarray  # exact minus what was found, in the units of the outputs
    size: np.ndarray  # the larger magnitude at start and end
    nominal: np.ndarray

    def worst(self, relative: float, absolute: float) -> tuple[float, str]:
        """Return the largest error against ``absolute * nominal + relative * size``, and whose it is."""
        if not self.labels:
            return 0.0, ""
        share = np.abs(self.error) / (absolute * self.nominal + relative * self.size)
        i = int(np.argmax(np.where(np.isfinite(share), share, np.inf)))
        return float(share[i]), self.labels[i]
