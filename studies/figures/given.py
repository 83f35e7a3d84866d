"""What the thesis and its papers print of their robots, and why another value is used or one is doubtful."""

from __future__ import annotations

from dataclasses import dataclass

WHAT = {
    "L_f": ("centre of mass to front axle", "m"), "L_r": ("centre of mass to rear axle", "m"),
    "h": ("centre of mass above the wheel centres", "m"), "R": ("wheel radius", "m"),
    "I_y": ("pitch moment of inertia", "kg.m2"), "m": ("mass of platform and payload", "kg"),
    "half_track": ("centre plane to a wheel", "m"), "I_x": ("roll moment of inertia", "kg.m2"),
    "I_z": ("yaw moment of inertia", "kg.m2"),
}  # fmt: skip
MISSING = "not given"
_BOX = "a box of the platform's size with the given I_y"
ASSUMED = {"half_track": "half the platform width of Table 8.1", "I_x": _BOX, "I_z": _BOX}


@dataclass(frozen=True)
class Table:
    """What a source prints of a robot: *printed* by symbol, and *why* another value is used or one is doubtful."""

    robot: str
    printed: dict[str, str]
    why: dict[str, str]


def _all(m: str) -> dict[str, str]:
    return {"L_f": "0.6 m", "L_r": "0.46 m", "h": "0.4 m", "R": "0.1 m", "I_y": "47 kg.m2", "m": m}


TABLES = {
    "thesis table 4.1": Table(
        "thesis_4_1", {"L_f": "0.6 m", "L_r": "0.46 m", "h": "0.4 m", "R": "none", "I_y": "0.1 m", "m": "47 kg.m2"},
        {"R": "the rows are shifted by one: 0.1 m is the radius", "I_y": "the rows are shifted: 47 kg.m2 is I_y",
         "m": "none is left; Table 6.1 has 170 kg, I_y = m L_f L_r at 170 kg, and Table 5.1 adds 100 kg to it"},
    ),
    "thesis table 5.1": Table(
        "thesis_5_1", _all("270 kg"), {"I_y": "as without the 100 kg of payload, said to lie about the centre of mass"}
    ),
    "thesis table 6.1": Table("thesis_6_1", _all("170 kg"), {}),
    "thesis table 8.1": Table(
        "thesis_8_1", {**_all("270 kg"), "half_track": "0.58 m wide"},
        {"half_track": "half of the width: wheels at its edges", "I_y": "the chassis that fits the frequencies has 26 "
         "kg.m2; 270 kg spread evenly need 1.45 m of length for 47"},
    ),
    "wheel impact paper table 1": Table("impact_paper", _all("170 kg"), {}),
    "smooth manoeuvre paper table 1": Table("pitch_paper", _all("270 kg"), {}),
    "DYMAC paper table": Table(
        "dymac_paper", {"L_f": "0.8 m", "L_r": "1.0 m", "h": "0.27 m", "I_y": "40 kg.m2", "m": "120 kg"},
        {"R": "as in all other tables", "h": "taken as above the wheel centres, as in the thesis"},
    ),
    "ASME paper table": Table(
        "asme_paper",
        {"L_f": "2.4 m less 1.2 m", "L_r": "1.2 m", "h": "0.4 m", "R": "0.1 m", "I_y": "116 kg.m2", "m": "80 kg"},
        {"L_r": "'between front axle and centre of mass, Lr': both are 1.2 m", "h": "taken as above the wheel centres"},
    ),
    "TIMR paper table": Table(
        "timr_paper",
        {"L_f": "1.0 m, as Lr", "L_r": "2.2 m less 1.0 m", "h": "0.42 m", "I_y": "80 kg.m2", "m": "50 kg"},
        {"L_f": "'between front axle and centre of mass, Lr = 1.0 m': taken as L_f", "R": "as in all other tables",
         "h": "taken as above the wheel centres"},
    ),
}  # fmt: skip


CHASSIS = (  # of Table 8.1 and section 8.2: symbol, meaning, printed, used and why; the used values are of PlateChassis
    ("length", "length of the platform", MISSING, "length", "m", "L_f + L_r: wheels at the corners"),
    ("L_w", "width of the platform", "0.58 m", "width", "m", ""),
    ("thickness", "thickness of the plate", MISSING, "thickness", "m", "fitted to ten frequencies"),
    ("E", "modulus of elasticity", "72 GPa", "E", "Pa", ""),
    ("nu", "Poisson's ratio", "0.33 kg", "nu", "", "printed with a unit"),
    ("rho", "density of aluminium", "2700 kg/m3", "", "", "26 kg of plate; the rest is equipment spread on it, below"),
    ("m plate", "mass spread on the plate", MISSING, "plate_mass", "kg", "fitted; with the boxes 270 kg as printed"),
    ("m boxes", "mass of the nine boxes", MISSING, "box_mass", "kg", "fitted"),
    ("E boxes", "stiffness of the boxes", MISSING, "box_E", "Pa", "fitted"),
    ("eta", "flexural loss factor", "1e-4", "damping", "", "used: the damping ratio, a half of it"),
    ("Delta omega", "change of the pitch rate (8.3 to 8.11)", MISSING, "", "", "0, as 'a minimum': the reaction at "
     "rest, or the rigid impact instead"),
    ("I_d", "moment of inertia about the diagonal (8.3)", MISSING, "", "", "cancels without Delta omega"),
)  # fmt: skip
FINITE_ELEMENTS = (  # Table 6.2: part, property, material, mass in kg, thickness in mm, number, of each wheel
    ("ground", "shell", "rigid", "203", "15", 539, False), ("wheel", "shell", "rubber", "0.83", "15", 64, True),
    ("wheel", "spring", "spring", "-", "-", 64, True), ("rim", "beam", "rigid", "-", "-", 32, True),
    ("axle", "beam", "rigid", "-", "-", 2, True), ("chassis", "beam", "rigid", "-", "-", 40, False),
    ("payload", "mass", "-", "170", "-", 4, False), ("accelerometer", "-", "-", "-", "-", 1, False),
    ("joints", "-", "-", "-", "-", 2, True),
)  # fmt: skip
