"""Tables of parameters: what is printed, what is missing, what is used here and why."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle

from plants.chassis_fe import PlateChassis
from plants.tables import ROBOTS, Robot

from .claim import UNKNOWN, Claim, graded
from .entry import Entry
from .given import ASSUMED, CHASSIS, FINITE_ELEMENTS, MISSING, TABLES, WHAT, Table
from .sheet import LINES, Sheet, panels

_HEADS = ("symbol", "meaning", "printed", "used", "why")


def rows(table: Table) -> list[tuple[str, ...]]:
    """Return symbol, meaning, what is printed, what is used and why, for each dimension of a robot."""
    bot = ROBOTS[table.robot]
    return [
        (s, what, table.printed.get(s, MISSING), f"{getattr(bot, s):g} {unit}", table.why.get(s, ASSUMED.get(s, "")))
        for s, (what, unit) in WHAT.items()
    ]


def robot_table(key: str) -> Sheet:
    """Return a table of parameters and the robot from the side, to scale."""
    bot = ROBOTS[TABLES[key].robot]
    figure, axes = panels(f"{bot.source}: from the side, to scale", figsize=(6.4, 3.6))
    side_view(axes[0, 0], bot)
    return Sheet("Parameters", _columns(rows(TABLES[key])), figure)


def _columns(found: Sequence[tuple[str, ...]]) -> dict[str, np.ndarray]:
    return {head: np.array(c) for head, c in zip(_HEADS, zip(*found, strict=True), strict=True)}


def side_view(axis: Axes, bot: Robot) -> None:
    """Draw a robot standing on the level, seen from the right: forward to the right, m."""
    for x in (-bot.L_r, bot.L_f):
        axis.add_patch(Circle((x, bot.R), bot.R, fill=False, color=LINES[5], linewidth=1.5))
    axis.add_patch(Rectangle((-bot.L_r, bot.R), bot.L, 0.04, color=LINES[0], alpha=0.4))
    axis.plot(0, bot.R + bot.h, "o", color=LINES[1], markersize=8)
    axis.annotate(f"{bot.m:g} kg, {bot.I_y:g} kg.m2", (0, bot.R + bot.h), (0.06, bot.R + bot.h + 0.03))
    arrow = {"arrowstyle": "<->", "color": LINES[5], "shrinkA": 0, "shrinkB": 0}
    level = bot.R + bot.h / 2
    for x, name in ((bot.L_f, f"L_f {bot.L_f:g}"), (-bot.L_r, f"L_r {bot.L_r:g}")):
        axis.annotate("", (0, level), (x, level), arrowprops=arrow)
        axis.text(x / 2, level + 0.02, name, ha="center", fontsize=9)
    axis.annotate("", (0, bot.R), (0, bot.R + bot.h), arrowprops=arrow)
    axis.text(0.02, bot.R + 0.75 * bot.h, f"h {bot.h:g}", fontsize=9)
    axis.axhline(0, color="black", linewidth=1)
    axis.set(aspect="equal", xlabel="x from the centre of mass / m", ylabel="height / m",
             xlim=(-bot.L_r - 0.3, bot.L_f + 0.4), ylim=(-0.05, bot.R + bot.h + 0.15))  # fmt: skip


def chassis_table() -> Sheet:
    """Return what is printed of the chassis, and the plate with its boxes from above, to scale."""
    plate = PlateChassis()
    found = [
        (symbol, what, printed, f"{getattr(plate, name):g} {unit}".strip() if name else "-", why)
        for symbol, what, printed, name, unit, why in CHASSIS
    ]
    figure, axes = panels("The fitted chassis from above: plate, boxes, stations", figsize=(6.4, 4.2))
    axis, (long, wide) = axes[0, 0], plate.box_size[:2]
    axis.add_patch(
        Rectangle((-plate.length / 2, -plate.width / 2), plate.length, plate.width, color=LINES[0], alpha=0.2)
    )
    for x in plate.box_pitch[0] * np.array([-1, 0, 1]):
        for y in plate.box_pitch[1] * np.array([-1, 0, 1]):
            axis.add_patch(Rectangle((x - long / 2, y - wide / 2), long, wide, color=LINES[3], alpha=0.6))
    for k in range(20):
        x, y = plate.length * (0.5 - k // 4 / 4), plate.width * (0.5 - k % 4 / 3)
        axis.text(x, y, str(k + 1), ha="center", va="center", fontsize=8)
    axis.set(aspect="equal", xlabel="x, forward / m", ylabel="y, left / m", xlim=(-0.6, 0.6), ylim=(-0.36, 0.36))
    return Sheet("Chassis", _columns(found), figure, ("numbers: stations; 1, 4, 17 and 20 are above the wheels",))


def chassis_claims() -> list[Claim]:
    """Return the verdicts on the mesh of section 8.2."""
    grid, nodes = (30, 20), (31, 21)
    return [
        Claim(
            "8.2",
            "the platform is 600 solid elements on 651 of 1299 nodes, each of 9 boxes 30 solid elements on 72 nodes",
            f"651 = {nodes[0]} x {nodes[1]} nodes are the corners of {grid[0]} x {grid[1]} = {grid[0] * grid[1]} "
            f"quadrilaterals: one layer of shells; as solids they need {2 * nodes[0] * nodes[1]} nodes. The boxes fit, "
            "5 x 3 x 2 bricks; 651 + 9 x 72 = 1299 leaves no node common to box and platform",
            graded(nodes[0] * nodes[1] != 651 or 2 * nodes[0] * nodes[1] <= 651),
            {"shell nodes": nodes[0] * nodes[1], "solid nodes": 2 * nodes[0] * nodes[1]},
        ),
        Claim(
            "8.2",
            "the printed properties give the printed frequencies",
            "a plate of 15.6 mm with boxes that are fitted meets ten frequencies to 4 % rms, and others do as well",
            UNKNOWN,
            assumption="thickness, length, boxes and the positions of the wheels are not given",
        ),
    ]


def elements_table() -> Sheet:
    """Return Table 6.2, and the numbers of its elements."""
    part, kind, material, mass, thickness, number, each = zip(*FINITE_ELEMENTS, strict=True)
    total = np.array(number) * np.where(each, 4, 1)
    figure, axes = panels("Elements of the model of LS-DYNA (Table 6.2)", figsize=(7.5, 3.4))
    names = [f"{p} {k}" for p, k in zip(part, kind, strict=True)]
    axes[0, 0].barh(names, total, color=LINES[0])
    axes[0, 0].set(xlabel="elements of all four wheels", xscale="log")
    columns = {
        "part": np.array(part), "property": np.array(kind), "material": np.array(material),
        "mass [kg]": np.array(mass), "thickness [mm]": np.array(thickness), "number": np.array(number), "in all": total,
    }  # fmt: skip
    notes = (
        "not given: stiffness of the springs, damping, how the payload is spread, dimensions of axles and chassis",
        "the model of full order here has a ring of 32 nodes for the 64 shells and 64 springs of each wheel",
    )
    return Sheet("Finite elements", columns, figure, notes)


def elements_claims() -> list[Claim]:
    """Return the verdict on the sums of Table 6.2."""
    elements = sum(number * (4 if each else 1) for *_, number, each in FINITE_ELEMENTS)
    mass = sum(float(m) * (4 if each else 1) for _, _, _, m, _, _, each in FINITE_ELEMENTS if m != "-")
    return [
        Claim(
            "Table 6.2",
            "1240 elements of 377 kg in all",
            f"{elements} elements of {mass:.1f} kg",
            graded(elements == 1240 and abs(mass - 377) < 0.5, elements == 1240),
            {"elements": elements, "mass": mass},
        )
    ]


def _mass_of_table_4_1() -> list[Claim]:
    bot = ROBOTS["thesis_4_1"]
    return [
        Claim(
            "Table 4.1",
            "the dimensions of the robot of chapter 4",
            f"its last rows are shifted, and no mass is left; I_y = m L_f L_r at {bot.I_y / bot.L_f / bot.L_r:.1f} kg",
            UNKNOWN,
            {"m": bot.I_y / bot.L_f / bot.L_r},
            assumption="170 kg of Table 6.1, to which Table 5.1 adds 100 kg",
        )
    ]


ENTRIES = (
    *(
        Entry(key, "dimensions of the robot", partial(robot_table, key),
              _mass_of_table_4_1 if key.endswith("4.1") else list)
        for key in TABLES
    ),
    Entry("thesis table 6.2", "the finite elements of the thesis", elements_table, elements_claims),
    Entry("thesis table 8.1 chassis", "properties of the chassis", chassis_table, chassis_claims),
)  # fmt: skip
