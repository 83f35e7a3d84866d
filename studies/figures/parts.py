"""The chapters and papers, in the order of the report, and in how far each is to be trusted."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Part:
    """A chapter or a paper: what it is *about*, and in how far its results are to be trusted."""

    about: str
    trust: str


PARTS = {  # in the order of the report
    "chapter 3": Part(
        "wheels and their slip control",
        "The slip model holds but for one sign: the mass that is driven adds to the damping of the slip (3.15, 3.16).",
    ),
    "chapter 4": Part(
        "a rigid robot on uneven ground: loss of contact, and the traction of least jerk",
        "The method holds once P (4.44) is put right. Its numbers hang on a pitch rate and a change of slope that are "
        "not given, and what (4.54) calls free of jerk is not: it holds the body still while it climbs.",
    ),
    "chapter 5": Part(
        "planning the pitch of a robot that climbs an obstacle",
        "The plan and its trends hold. Its shortest time is that of a pitch which is not given, and no wheel can "
        "follow the end of its obstacle: pitch, profile and speed cannot be chosen apart.",
    ),
    "chapter 6": Part(
        "keeping deformable wheels on the ground after an impact",
        "The control law is right by two errors of sign that cancel, and works if traction has no limit. Friction "
        "gives less than a hundredth of what it asks for, and then the wheels rebound.",
    ),
    "chapter 7": Part(
        "how the chassis responds to a shock: method",
        "The modal formulas hold up to one constant factor and misprints. A series to 200 Hz is not accurate for a "
        "pulse that jumps, and peak accelerations under such a pulse grow with every mode that is kept.",
    ),
    "chapter 8": Part(
        "how the chassis responds to a shock: cases",
        "Which modes take part follows from symmetry and holds, and corners are the place to avoid. Accelerations in g "
        "are those of one number of modes; comparisons between cases hold for equal total force only.",
    ),
    "wheel impact paper": Part("chapter 6 in short", "As chapter 6."),
    "smooth manoeuvre paper": Part(
        "chapter 5 in short, over another obstacle",
        "As chapter 5. The same shortest time over another obstacle needs another pitch, and it brakes throughout.",
    ),
    "DYMAC paper": Part(
        "least jerk: another robot, its parameters varied",
        "Its force is the one at which a_z does not change with the slope, to 6 %; that is not a motion without jerk.",
    ),
    "ASME paper": Part(
        "least jerk over a hump: longitudinal, normal and pitch",
        "Normal and pitch jerk vanish together as it says, the longitudinal one does not; forces to 2 to 14 %.",
    ),
    "TIMR paper": Part(
        "least jerk: longitudinal", "As the ASME paper: longitudinal and normal jerk do not vanish together."
    ),
    "shock paper": Part(
        "three shapes of a pulse on the chassis",
        "Its dynamic loads are reproduced to the digit, and are a resonance with a rate of repetition chosen by hand.",
    ),
    "co-simulation": Part(
        "what the thesis could not do",
        "The chassis under the wheel forces of a collision: corners stay the worst place, but two wheels at once are "
        "not milder than one.",
    ),
}
