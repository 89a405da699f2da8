"""The integrator of the virtual rigs against scipy with a second writing of the physics, and against itself."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.concealed.engine import Drive, simulate
from scipy.integrate import solve_ivp

W, A = 2 * np.pi * 10.0, 5e-3  # rad/s, m
K = W**2
FS = 600.0
BASE = {"mass": 2.0, "omega2": K, "omega": W, "amplitude": A, "force": 0.06 * K * A}
PEAK = 2.0 * 0.06 * K * A  # N
REST = Drive("none")
SWEEP = Drive("linear", PEAK, 7.0, 16.0, 2.5, 0.3)
LINES = np.column_stack([np.linspace(6, 15, 12), np.full(12, 0.4), np.linspace(0, 40, 12)])
MULTISINE = Drive("multisine", PEAK, length=3.0, ramp=0.3, lines=LINES)


def sampled(count: int) -> np.ndarray:
    return np.arange(count) / FS


def force(drive: Drive, t: float) -> float:
    """The drive once more, straight from its meaning."""
    if t < 0:
        return 0.0
    rise = np.sin(np.pi / 2 * min(t / drive.ramp, 1.0)) ** 2
    if drive.kind == "linear":
        return (
            drive.peak
            * rise
            * np.sin(2 * np.pi * (drive.start * t + (drive.end - drive.start) / drive.length * t * t / 2))
        )
    if drive.kind == "logarithmic":
        rate = np.log(drive.end / drive.start) / drive.length
        return drive.peak * rise * np.sin(2 * np.pi * drive.start / rate * (np.exp(rate * t) - 1))
    if drive.kind == "multisine":
        f, amplitude, phase = drive.lines.T
        return drive.peak * rise * float(np.sum(amplitude * np.sin(2 * np.pi * f * t + phase)))
    return 0.0


@pytest.mark.parametrize("drive", [SWEEP, MULTISINE, Drive("logarithmic", PEAK, 16.0, 6.0, 3.0, 0.3), REST])
def test_recorded_force_is_the_drive(drive):
    recorded = simulate(BASE | {"viscous": W}, drive, 0.0, FS, 1800).force
    exact = np.array([force(drive, t) for t in sampled(1800)])
    assert np.abs(recorded - exact).max() <= 1e-12 * PEAK


def test_straight_lines_between_samples():
    """A mass without a spring worth the name under them: closed form."""
    samples = np.random.default_rng(1).normal(size=50)
    lines = np.column_stack([samples[:-1], np.diff(samples)])
    law = {"mass": 1.0, "omega2": 1e-14, "omega": 1.0, "amplitude": 1.0, "force": 1.0}
    response = simulate(law, Drive("straight", 1.0, ramp=0.0, lines=lines), 0.0, 1.0, 50)
    x = v = 0.0
    for k, (value, rise) in enumerate(lines):
        x, v = x + v + value / 2 + rise / 6, v + value + rise / 2
        assert response.x[k + 1] == pytest.approx(x, rel=1e-8, abs=1e-9)
    assert response.force[:-1] == pytest.approx(samples[:-1], rel=1e-12)


def positive(value: float) -> float:
    return max(value, 0.0)


def contact(p: dict[str, float], name: str, lead: float, speed: float) -> float:
    """Force of a body that leads the rig by `lead` through a gap: springs and dampers that only push."""
    gap, k, c = (p[f"{name}_{word}"] for word in ("gap", "stiffness", "damping"))
    up = positive(k * (lead - gap) + c * speed) if lead > gap else 0.0
    down = positive(k * (-lead - gap) - c * speed) if lead < -gap else 0.0
    return up - down


class Physics:
    """The rig's equations written a second time: plain, without modes, for scipy. States beyond x and v by name."""

    def __init__(self, parameters: dict[str, float], drive: Drive):
        self.p = {"mass": 1.0} | parameters
        self.drive = drive
        self.extra = [name for key, name in EXTRA if key in parameters]

    def get(self, name: str) -> float:
        return self.p.get(name, 0.0)

    def passed_on(self, t: float) -> float:
        p = self.p
        value = force(self.drive, t - self.get("input_delay"))
        value = np.sign(value) * positive(abs(value) - self.get("dead_zone"))
        if "hard_limit" in p:
            value = float(np.clip(value, -p["hard_limit"], p["hard_limit"]))
        if "smooth_limit" in p:
            value = p["smooth_limit"] * np.tanh(value / p["smooth_limit"])
        return value / p["mass"]

    def arrived(self, force: float) -> float:
        """What grows with the square of a force per unit mass, behind the lag."""
        part = self.get("quadratic_part")
        return (1.0 - part) * force + part * abs(force) * force * self.p["mass"] / self.p.get("quadratic_level", 1.0)

    def __call__(self, t: float, y: np.ndarray) -> list[float]:
        p, get, x, v = self.p, self.get, y[0], y[1]
        q = dict(zip(self.extra, y[2:], strict=True))
        rates: dict[str, float] = {}
        stiffness = 1 + get("drift_rate") * t
        if "drift_gain" in p:
            stiffness += p["drift_gain"] * (1 - np.exp(-t / p["drift_time"]))
        if "modulation" in p:
            stiffness += p["modulation"] * np.cos(p["modulation_omega"] * t + p["modulation_phase"])
        a = -get("omega2") * stiffness * x - get("quadratic") * x**2 - get("cubic") * x**3 - get("quintic") * x**5
        a -= get("static_load") + get("preload") * np.sign(x) + get("speed_stiffness") * x * v**2
        a -= get("viscous") * (1 + get("damping_rate") * t) * v + get("drag") * v * abs(v)
        a -= get("cubic_damping") * v**3 + get("x2_damping") * x**2 * v + get("direction_viscous") * abs(v)
        level = get("dry") + get("friction_gain") * (1 - np.exp(-t / p.get("friction_time", 1.0)))
        if "stribeck_excess" in p:
            level += p["stribeck_excess"] * np.exp(-((abs(v) / p["stribeck_speed"]) ** p["stribeck_power"]))
        a -= np.sign(v) * level + get("direction_dry")
        for kind, function in (("tanh", np.tanh), ("sine", np.sin)):
            if f"{kind}_stiffness" in p:
                length = p[f"{kind}_length"]
                a -= p[f"{kind}_stiffness"] * length * function(x / length)
        a -= get("clearance_stiffness") * np.sign(x) * positive(abs(x) - get("clearance_gap"))
        for side, sign in (("up", 1.0), ("down", -1.0)):
            depth = sign * x - get(f"{side}_at")
            if f"{side}_stiffness" in p and depth > 0:
                a -= sign * positive(p[f"{side}_stiffness"] * depth + get(f"{side}_damping") * sign * v)
        if "valve_damping" in p:
            a -= p["valve_damping"] * np.sign(v) * positive(abs(v) - p["valve_speed"])
        if "tone" in p:
            a += p["tone"] * np.sin(p["tone_omega"] * t + p["tone_phase"])
        if "bouc" in q:
            n, z = p["bouc_power"], q["bouc"]
            a -= p["bouc_stiffness"] * z
            rates["bouc"] = v - p["bouc_beta"] * abs(v) * abs(z) ** (n - 1) * z - p["bouc_gamma"] * v * abs(z) ** n
        if "dahl" in q:
            a -= p["dahl_stiffness"] * q["dahl"]
            rates["dahl"] = v * (1 - np.sign(v) * q["dahl"] / p["dahl_reach"])
        for i in range(1, 6):
            if f"maxwell_{i}" in q:
                a -= q[f"maxwell_{i}"]
                rates[f"maxwell_{i}"] = p[f"maxwell_{i}"] * v - p[f"relaxation_{i}"] * q[f"maxwell_{i}"]
        drive, inertia = self.passed_on(t), 1.0
        if "lag" in q:
            rates["lag"] = (drive - q["lag"]) / p["actuator_lag"]
            drive = q["lag"]
        drive = self.arrived(drive)
        drive *= 1 - get("force_factor") * x**2
        if "coil" in q:
            push = contact(p, "coil", q["coil"] - x, q["coil_v"] - v)
            rates |= {"coil": q["coil_v"], "coil_v": (drive - push) / p["coil_mass"]}
            drive, inertia = push, inertia - p["coil_mass"]
        a += drive
        if "loose" in q:
            push = contact(p, "loose", q["loose"] - x, q["loose_v"] - v)
            a += push
            rates |= {"loose": q["loose_v"], "loose_v": -push / p["loose_mass"]}
        if "resonator" in q:
            w, z = p["resonator_omega"], p["resonator_zeta"]
            pull = w**2 * (q["resonator"] - x) + 2 * z * w * (q["resonator_v"] - v)
            a += p["resonator_mass"] * pull
            rates |= {"resonator": q["resonator_v"], "resonator_v": -pull}
        if "second" in q:
            w, z, c = p["second_omega"], p["second_zeta"], p["second_coupling"]
            a -= 2 * c * x * q["second"]
            rates |= {
                "second": q["second_v"],
                "second_v": -(w**2) * q["second"] - 2 * z * w * q["second_v"] - c * x**2,
            }
        if "inertia" in p:
            a -= p["inertia"] * x * v**2
            inertia += p["inertia"] * x**2
        acceleration = a / inertia
        if "pendulum" in q:  # both accelerations from Lagrange's equations, as a 2 by 2 system
            m, length, th, om = p["pendulum_mass"], p["pendulum_length"], q["pendulum"], q["pendulum_v"]
            back = p["pendulum_omega"] ** 2 * th + 2 * p["pendulum_zeta"] * p["pendulum_omega"] * om
            matrix = [[1 + m, m * length * np.cos(th)], [np.cos(th) / length, 1.0]]
            acceleration, rates["pendulum_v"] = np.linalg.solve(matrix, [a + m * length * np.sin(th) * om**2, -back])
            rates["pendulum"] = om
        if "sensor" in q:
            rates["sensor"] = (x - q["sensor"]) / p["sensor_lag"]
        if "mean_x" in q:
            omega = np.sqrt(positive(q["mean_v"]) / (positive(q["mean_x"]) + 1e-12 * A**2))
            switch = 0.5 * (1 + np.tanh((omega - p["switch_omega"]) / p["switch_width"]))
            acceleration -= p["switched_damping"] * switch * v
            rates |= {"mean_x": (x**2 - q["mean_x"]) / p["switch_memory"]}
            rates |= {"mean_v": (v**2 - q["mean_v"]) / p["switch_memory"]}
        return [v, acceleration, *(rates[name] for name in self.extra)]


EXTRA = [
    ("bouc_stiffness", "bouc"),
    ("dahl_stiffness", "dahl"),
    *((f"maxwell_{i}", f"maxwell_{i}") for i in range(1, 6)),
    ("actuator_lag", "lag"),
    *((key, key.split("_")[0] + v) for key in ("coil_mass", "loose_mass", "resonator_mass") for v in ("", "_v")),
    *((key, key.split("_")[0] + v) for key in ("second_coupling", "pendulum_mass") for v in ("", "_v")),
    ("sensor_lag", "sensor"),
    ("switched_damping", "mean_x"),
    ("switched_damping", "mean_v"),
]

SPRING, SPEED = K * A, W * A
DRY = {"dry": 0.004 * SPRING}
COIL = {"coil_mass": 0.06, "coil_gap": 0.02 * A, "coil_stiffness": 0.06 * (8 * W) ** 2, "coil_damping": 0.4 * W}
LOOSE = {"loose_mass": 0.05, "loose_gap": 0.2 * A, "loose_stiffness": 0.05 * (8 * W) ** 2, "loose_damping": 0.3 * W}
RESONATOR = {"resonator_mass": 0.08, "resonator_omega": 1.3 * W, "resonator_zeta": 0.02}
PENDULUM = {"pendulum_mass": 0.1, "pendulum_length": 1.5 * A, "pendulum_omega": 1.1 * W, "pendulum_zeta": 0.01}
MAXWELL = {"maxwell_1": 0.2 * K, "relaxation_1": W, "maxwell_4": 0.1 * K, "relaxation_4": 5 * W}
SWITCH = {"switched_damping": 0.1 * W, "switch_omega": W, "switch_width": 0.05 * W, "switch_memory": 10 / W}
SMOOTH = {
    "polynomial": {
        "quadratic": 0.2 * K / A,
        "cubic": 0.3 * K / A**2,
        "quintic": 0.2 * K / A**4,
        "static_load": 0.1 * SPRING,
    },
    "saturating": {
        "tanh_stiffness": 0.4 * K,
        "tanh_length": 0.4 * A,
        "sine_stiffness": 0.3 * K,
        "sine_length": 0.5 * A,
    },
    "damping": {"cubic_damping": 0.05 * SPRING / SPEED**3, "x2_damping": 0.1 * W / A**2, "damping_rate": 0.5},
    "maxwell": MAXWELL,
    "resonator": RESONATOR,
    "actuator": {"actuator_lag": 0.15 / W, "smooth_limit": 0.8 * PEAK, "force_factor": 0.2 / A**2},
    "drift": {"drift_rate": 0.02, "drift_gain": 0.05, "drift_time": 1.0},
    "disturbed": {"tone": 0.02 * SPRING, "tone_omega": 0.7 * W, "tone_phase": 1.0}
    | {"modulation": 0.1, "modulation_omega": 0.4 * W, "modulation_phase": 2.0},
    "pendulum": PENDULUM,
    "inertia": {"inertia": 0.3 / A**2, "speed_stiffness": 0.2 * K / SPEED**2},
    "second": {"second_coupling": 0.3 * K / A, "second_omega": 2.0 * W, "second_zeta": 0.01},
    "switched": SWITCH,
    "delayed": {"input_delay": 0.15 / W},
    "quadratic": {"quadratic_part": 0.7, "quadratic_level": PEAK},
    "quadratic behind a lag": {"quadratic_part": 1.0, "quadratic_level": PEAK, "actuator_lag": 0.1 / W},
}
BROKEN = {
    "clearance": {"clearance_stiffness": K, "clearance_gap": 0.3 * A},
    "stops": {"up_stiffness": 3 * K, "up_at": 0.3 * A, "up_damping": 0.4 * W, "down_stiffness": K, "down_at": 0.4 * A},
    "drag": {"drag": 0.05 / A, "direction_viscous": 0.02 * W},
    "bouc": {"bouc_stiffness": 0.2 * K, "bouc_beta": 0.7 / (0.2 * A) ** 1.5, "bouc_gamma": 0.3 / (0.2 * A) ** 1.5}
    | {"bouc_power": 1.5},
    "dahl": {"dahl_stiffness": 0.2 * K, "dahl_reach": 0.2 * A},
    "coil": COIL,
    "loose": LOOSE,
    "clipped": {"hard_limit": 0.5 * PEAK, "dead_zone": 0.1 * PEAK},
    "valve": {"valve_damping": 0.1 * W, "valve_speed": 0.3 * SPEED},
}
RUBBING = {
    "dry": DRY | {"preload": 0.02 * SPRING},
    "directed": DRY | {"direction_dry": 0.002 * SPRING},
    "stribeck": {"stribeck_excess": 0.01 * SPRING, "stribeck_speed": 0.1 * SPEED, "stribeck_power": 2.0},
    "exponential": {"stribeck_excess": 0.01 * SPRING, "stribeck_speed": 0.1 * SPEED, "stribeck_power": 1.0},
    "run in": {"friction_gain": 0.01 * SPRING, "friction_time": 0.5},
}
VISCOUS = {"viscous": 0.04 * W}
SAMPLES = 900  # 15 cycles


def second_opinion(
    parameters: dict[str, float], drive: Drive, x0: float = 0.0, samples: int = SAMPLES, corners: bool = True
) -> np.ndarray:
    """The displacement by DOP853; bodies on the rig start where it rests."""
    physics = Physics(parameters, drive)
    start = [x0, 0.0, *(x0 if name in {"resonator", "coil", "loose", "sensor"} else 0.0 for name in physics.extra)]
    size = {"mean_x": A**2, "mean_v": SPEED**2, "lag": 0.03 * SPRING, "pendulum": 0.3, "pendulum_v": 0.3 * W}
    size |= {f"maxwell_{i}": SPRING for i in range(1, 6)}
    scale = np.array([A, SPEED, *(size.get(n, SPEED if n.endswith("_v") else A) for n in physics.extra)])
    t = sampled(samples)
    # Between a kink and the next the step must not grow so long that it misses one.
    longest = 0.1 / W if corners else np.inf
    solution = solve_ivp(physics, (0, t[-1]), start, "DOP853", t, rtol=1e-11, atol=1e-11 * scale, max_step=longest)
    return solution.y[0]


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("drive", [SWEEP, MULTISINE], ids=["sweep", "multisine"])
def test_smooth_rigs_agree_with_scipy(name, drive):
    parameters = BASE | VISCOUS | SMOOTH[name]
    exact = second_opinion(parameters, drive, corners=False)
    motion = simulate(parameters, drive, 0.0, FS, SAMPLES).x
    assert np.abs(exact).max() > 0.05 * A
    assert np.abs(motion - exact).max() < 1e-7 * np.abs(exact).max()


@pytest.mark.parametrize("name", BROKEN)
def test_rigs_with_corners_agree_with_scipy(name):
    parameters = BASE | VISCOUS | BROKEN[name]
    exact = second_opinion(parameters, SWEEP)
    response = simulate(parameters, SWEEP, 0.0, FS, SAMPLES)
    assert response.events > 10
    assert np.abs(response.x - exact).max() < 1e-5 * np.abs(exact).max()


@pytest.mark.parametrize("name", RUBBING)
def test_friction_agrees_with_scipy_while_the_rig_does_not_stick(name):
    parameters = BASE | VISCOUS | RUBBING[name]
    exact = second_opinion(parameters, REST, A, 400)
    motion = simulate(parameters, REST, A, FS, 400).x
    assert np.abs(motion - exact).max() < 1e-5 * A


@pytest.mark.parametrize("extra", [RESONATOR, COIL, LOOSE, MAXWELL], ids=["resonator", "coil", "loose", "maxwell"])
def test_release_from_rest_agrees_with_scipy(extra):
    parameters = BASE | VISCOUS | extra
    exact = second_opinion(parameters, REST, A)
    assert np.abs(simulate(parameters, REST, A, FS, SAMPLES).x - exact).max() < 1e-5 * A


STICKING = {
    "friction": DRY | {"preload": 0.01 * SPRING},
    "stribeck": {"stribeck_excess": 0.008 * SPRING, "stribeck_speed": 0.05 * SPEED, "stribeck_power": 1.0} | DRY,
    "jenkins": {"jenkins_stiffness": 0.1 * K, "jenkins_reach": 0.2 * A} | DRY,
    "play": {"sensor_play": 1.0, "jenkins_reach": 0.02 * A},
    "dahl": {"dahl_stiffness": 0.1 * K, "dahl_reach": 0.1 * A, "preload": 0.01 * SPRING},
    "stuck and clipped": DRY | {"dead_zone": 0.2 * PEAK, "hard_limit": 0.6 * PEAK, "actuator_lag": 0.1 / W},
    "everything": DRY | COIL | RESONATOR | MAXWELL | BROKEN["stops"],
}


@pytest.mark.parametrize("name", STICKING)
@pytest.mark.parametrize("drive", [SWEEP, REST], ids=["sweep", "ringdown"])
def test_shorter_steps_change_nothing(name, drive):
    parameters, x0 = BASE | VISCOUS | STICKING[name], A if drive is REST else 0.0
    response = simulate(parameters, drive, x0, FS, 1800)
    finer = simulate(parameters, drive, x0, FS, 1800, tolerance=1e-13, steps_per_cycle=407)
    assert response.events > 10
    assert np.abs(response.x).max() > 0.1 * A
    assert np.abs(response.shown - finer.shown).max() < 1e-5 * np.abs(finer.shown).max()


def test_sensor_shows_what_its_formula_says():
    plain = simulate(BASE | VISCOUS, SWEEP, 0.0, FS, 1800).x
    odd = {"sensor_square": 0.05 / A, "sensor_cube": 0.04 / A**2, "sensor_offset": 0.01 * A}
    shown = simulate(BASE | VISCOUS | odd, SWEEP, 0.0, FS, 1800).shown
    assert np.abs(shown - (plain + 0.05 / A * plain**2 + 0.04 / A**2 * plain**3 + 0.01 * A)).max() < 1e-15
    bent = simulate(BASE | VISCOUS | {"sensor_length": 2 * A}, SWEEP, 0.0, FS, 1800).shown
    assert np.abs(bent - 2 * A * np.tanh(plain / (2 * A))).max() < 1e-15
    twice = simulate(BASE | VISCOUS, SWEEP, 0.0, 2 * FS, 3600).x
    late = simulate(BASE | VISCOUS | {"output_delay": 0.5 / FS}, SWEEP, 0.0, FS, 1800).shown
    assert np.abs(late[1:] - twice[1:-1:2]).max() < 1e-8 * A


def test_lagging_sensor_is_the_first_order_filter():
    # x' of the filter is known wherever its output is: tau y' = x - y, checked by the trapezoidal rule on fine samples.
    tau, fs = 0.15 / W, 50 * FS
    response = simulate(BASE | VISCOUS | {"sensor_lag": tau}, SWEEP, 0.0, fs, 20000)
    gap = response.x - response.shown
    change = np.cumsum((gap[1:] + gap[:-1]) / 2) / fs / tau
    assert np.abs(change - response.shown[1:]).max() < 1e-5 * np.abs(response.shown).max()


def test_hysteresis_starts_on_its_virgin_curve():
    # Released from A, the springs in parallel pull with omega2 A and the hysteretic part of a slow pull to A.
    reach, t = 0.2 * A, 1e-4 / W
    for name, z in (("dahl", reach * (1 - np.exp(-A / reach))), ("jenkins", reach)):
        parameters = BASE | {f"{name}_stiffness": 0.2 * K, f"{name}_reach": reach}
        motion = simulate(parameters, REST, A, 1 / t, 2).x
        assert A - motion[1] == pytest.approx((K * A + 0.2 * K * z) * t**2 / 2, rel=1e-3)
    loss = 1 / reach
    parameters = BASE | {
        "bouc_stiffness": 0.2 * K,
        "bouc_beta": 0.6 * loss,
        "bouc_gamma": 0.4 * loss,
        "bouc_power": 1.0,
    }
    motion = simulate(parameters, REST, A, 1 / t, 2).x
    assert A - motion[1] == pytest.approx((K * A + 0.2 * K * reach * (1 - np.exp(-A / reach))) * t**2 / 2, rel=1e-3)


def test_unknown_parameters_and_runaways_are_refused():
    with pytest.raises(ValueError, match="no parameter springiness"):
        simulate(BASE | {"springiness": 1.0}, REST, A, FS, 10)
    with pytest.raises(RuntimeError, match="diverged"):
        simulate(BASE | {"quadratic": 10 * K / A}, REST, -A, FS, 6000)
