"""Controllers as components, what stands in their connections, and how they are designed."""

EQUATIONS_ARE_KEPT = True  # they depend on this package and cosim alone
