"""The robot: body, wheels, chassis and ground as components, and the models that they are checked against."""

EQUATIONS_ARE_KEPT = True  # they depend on this package and cosim alone
