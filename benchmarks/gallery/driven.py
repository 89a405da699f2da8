"""Recordings under a recorded force, and those whose motion was imposed, which are no oscillators."""

from __future__ import annotations

from .entry import Bounds, Columns, Entry, Piece, Published

_NOTES = "README of the recordings"
_TODAY = "measured with this software before, the project's issue on real recordings"
_BASELINES = "arXiv 2405.10779 and its repository"
#: 10 MHz / 2^14.
_SILVERBOX_FS = 610.3515625
_BEAM = Columns("velocity_m_s", "force_N", quantity="velocity")
_BEAM_FIGURES = (
    Published("first mode, Eq. 17", 18.0, "%", _NOTES),
    Published("first mode, with a quintic", 4.0, "%", _NOTES),
)
_WHEEL = Columns("driver_rad", "phi_rad")
_WHEEL_OPTIONS = ("--force", "phi_rad", "--force-unit", "V", "--response", "driver_rad")
_WHEEL_NOTE = (
    "The columns bear each other's names: phi_rad keeps its amplitude throughout the sweep, driver_rad passes a "
    "resonance at 4.3 rad/s and lags by 90 degrees there. So phi_rad is taken as the force; its unit is written V."
)


def _silverbox(name: str, first: int, last: int, judged: tuple[int, int | None] | None = None) -> Piece:
    return Piece("silverbox_snls80mv.csv.gz", rows=(first, last), name=f"{name}.csv", judged=judged)


def _hammered(number: int) -> Entry:
    return Entry(
        f"beam_mec_{number}",
        f"Clamped-clamped beam, hammer with force, laser velocity; blow {number}",
        "forced",
        (Piece(f"beam_mec_{number}.csv.gz", motion=(0.0, 4.0)),),
        _BEAM,
        "hardening, cubic and quintic; modes at about 29.5, 165 and 276 Hz",
        documented=("quintic-stiffness", "attached-resonator"),
        # the laser looks from the other side: dashpot says so, and what to do
        options=("--calibration", "response=-1"),
        published=_BEAM_FIGURES,
        note="The figures beside are of the first mode alone. The velocity goes against the blows. Small "
        "motion after the two is at 139.7 and at 135.9 Hz: two rigs, as dashpot says where one of them is to judge the "
        "other.",
    )


def _wheel(gap: int, damping: float) -> Entry:
    return Entry(
        f"driven_wheel_{gap}mm",
        f"Wheel driven through its spring, eddy-current brake at {gap} mm, slow sweep",
        "forced",
        (Piece(f"driven_wheel_{gap}mm.csv.gz"),),
        _WHEEL,
        f"linear: damping about {damping} 1/s, omega0 4.28 to 4.39 rad/s",
        options=_WHEEL_OPTIONS,
        documented=("sensor-offset", "constant-force"),
        linear=True,
        note=_WHEEL_NOTE,
    )


DRIVEN = (
    Entry(
        "stand",
        "The paper's stand with actuator backlash",
        "forced",
        tuple(Piece(f"stand/{name}.csv.gz") for name in ("bursts", "sweep_low", "sweep_high")),
        Columns("displacement_m", "force_N"),
        "backlash between shaker and mass (section 5 of the paper)",
        holdout=(Piece("stand/multisine.csv.gz"),),
        documented=("actuator-backlash",),
        note="Virtual; it comes with the package.",
    ),
    _hammered(1),
    _hammered(2),
    Entry(
        "torsion_lab_driven",
        "Torsion pendulum of a teaching lab, driven at 0.8 Hz",
        "forced",
        (Piece("torsion_lab_driven_800mHz_3Vpp.csv.gz"),),
        Columns("angle_V", "drive_V"),
        "nearly linear, about 0.868 Hz; the transducer rests at 1.4 V",
        options=("--force", "drive_V", "--response", "angle_V"),
        documented=("sensor-offset",),
        linear=True,
        note="One frequency: mass and stiffness cannot be told apart.",
        quick=True,
    ),
    Entry(
        "aeroshield",
        "Pendulum driven by a propeller, random steps of the fan's voltage",
        "forced",
        (Piece("aeroshield_pendulum_ident.csv.gz"),),
        Columns("phi_rad", "motor_V"),
        "gravity is a sine; thrust one way only and as the square of the fan's speed; the fan lags",
        options=("--force", "motor_V"),
        documented=("softening-stiffness", "actuator-lag", "actuator-dead-zone"),
        quick=True,
    ),
    Entry(
        "friction_frame_250g",
        "Storey frame on a moving base, dry contact",
        "forced",
        (Piece("friction_frame_250g.csv.gz"),),
        Columns("x_mm", "force_N"),
        "dry friction in proportion to the load, its law possibly rate dependent; sticking",
        options=("--force", "force_N", "--response", "x_mm"),
        documented=("stribeck", "hysteresis", "asymmetric-friction"),
        linear=True,
        note="One frequency: mass and stiffness cannot be told apart. The force is made from the base's motion, by the "
        "authors' figures.",
        quick=True,
    ),
    _wheel(1, 0.9),
    _wheel(5, 0.3),
    Entry(
        "rl_diode",
        "Resistor, inductor and diode under a sine of 130 kHz",
        "forced",
        (Piece("rl_diode_130kHz.csv.gz"),),
        Columns("resistor_V", "source_V", quantity="velocity"),
        "a spring that is exponential on one side, reverse-recovery memory",
        options=("--force", "source_V", "--response", "resistor_V", "--quantity", "velocity"),
        documented=("quadratic-stiffness", "one-sided-stop", "hysteresis", "viscoelastic"),
        quick=True,
    ),
    Entry(
        "silverbox",
        "Electronic circuit like a mass on a hardening spring",
        "forced",
        (_silverbox("train", 40650, 92699),),
        Columns("V2_V", "V1_V", time=None, fs=_SILVERBOX_FS),
        "hardening cubic spring",
        # three quarters of the multisines to learn from, and of these a fifth to judge by
        holdout=(_silverbox("holdout", 92699, 105712),),
        tests=(
            _silverbox("multisine", 105712, 127400, (50, None)),
            _silverbox("arrow", 100, 40575, (50, 32_000)),
        ),
        options=("--force", "V1_V", "--response", "V2_V", "--quantity", "displacement", "--fs", str(_SILVERBOX_FS)),
        linear=True,
        published=(
            Published("multisine, linear model", 6.99, "mV", _BASELINES),
            Published("multisine, GRU", 1.49, "mV", _BASELINES),
            Published("arrow without extrapolation, GRU", 0.95, "mV", _BASELINES),
            Published("polynomial state space, about", 0.3, "mV", _NOTES),
            Published("multisine, 15-parameter grey box", 0.2455, "mV", "the project's measured facts"),
            Published("multisine", 0.235, "mV", _TODAY),
            Published("arrow without extrapolation", 0.264, "mV", _TODAY),
        ),
    ),
    Entry(
        "emps",
        "Motor and ball screw in closed loop, no spring",
        "forced",
        (Piece("emps_train.csv.gz"),),
        Columns("x_m", "F_N", time="t_s"),
        "inertia, viscous and dry friction, an offset of the drive; no spring",
        documented=("asymmetric-friction", "constant-force"),
        published=(
            Published("mass", 93.0, "kg", _TODAY),
            Published("viscous times mass", 209.0, "N s/m", _TODAY),
            Published("dry times mass", 20.0, "N", _TODAY),
        ),
    ),
    Entry(
        "flexible_link",
        "Motor and flexible link, swept command in counts",
        "forced",
        (Piece("flexible_link_swept1_0_10hz.csv.gz"),),
        Columns("hub_counts", "motor_counts"),
        "dry friction and dead band of the motor, a second mode; no spring at the hub",
        options=("--force", "motor_counts", "--response", "hub_counts", "--quantity", "displacement"),
        documented=("actuator-dead-zone", "attached-resonator", "actuator-lag"),
        note="Command and encoder in counts. The command stays at 200 counts on some peaks.",
        quick=True,
    ),
)

IMPOSED = (
    Entry(
        "mr_damper_0A",
        "Damper in a test machine, 5 mm at 3 Hz, no current",
        "imposed",
        (Piece("mr_damper_utfsm_5mm3Hz0A.csv.gz"),),
        None,
        "hysteresis of Bouc-Wen's kind, no inertia",
        options=("--force", "force_N", "--response", "displacement_mm"),
        note="Motion imposed: not for this method yet.",
        quick=True,
    ),
    Entry(
        "mr_damper_05A",
        "Damper in a test machine, 25 mm at 0.5 Hz, 0.5 A",
        "imposed",
        (Piece("mr_damper_utfsm_25mm0x5Hz0x5A.csv.gz"),),
        None,
        "hysteresis of Bouc-Wen's kind, no inertia",
        options=("--force", "force_N", "--response", "displacement_mm"),
        note="Motion imposed: not for this method yet.",
        quick=True,
    ),
    Entry(
        "pneumatic_KDN_7bar",
        "Seal of a pneumatic cylinder, pushed in and out",
        "imposed",
        (Piece("pneumatic_KDN_7bar.csv.gz"),),
        None,
        "seal friction that grows with the pressure, pre-sliding",
        options=("--force", "friction_N", "--response", "x_mm"),
        note="Motion imposed: not for this method yet.",
        quick=True,
        bounds=Bounds(verdicts=("refused", "consistent", "unexplained")),  # no name of a motion that is imposed
    ),
)
