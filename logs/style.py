"""Colours: variant A is blue and B orange everywhere, in tables of series, scenes and pictures."""

Colour = tuple[int, int, int]

PALETTE: tuple[Colour, ...] = (
    (31, 120, 209), (240, 128, 32), (42, 157, 74), (168, 62, 196), (214, 57, 43),
    (0, 165, 170), (205, 165, 0), (236, 110, 168), (140, 100, 70), (130, 130, 130),
    (110, 190, 250), (160, 215, 110), (250, 195, 130), (205, 165, 235),
)  # fmt: skip
WHEELS = ("fl", "fr", "rl", "rr")
WHEEL_COLOURS: tuple[Colour, ...] = ((31, 120, 209), (130, 190, 250), (240, 128, 32), (250, 190, 120))


def colour(number: int) -> Colour:
    """Return the colour of the *number*-th of several things, from 0; they repeat after fourteen."""
    return PALETTE[number % len(PALETTE)]


def pale(of: Colour) -> Colour:
    """Return a colour half way to grey: for what is beside the point."""
    return (of[0] // 2 + 60, of[1] // 2 + 60, of[2] // 2 + 60)
