"""Scores of palpate-calibrate wrist on simulated wrists; see measure_wrist."""

import sys
from pathlib import Path

import numpy as np

TOOLS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOOLS / folder) for folder in ("calibrate", "common", "lab/goals")]

import simulated_wrist as simulated
from goal_text import LEAST_HOLD, NOMINAL, TOO_WIDE, bootstrap
from palpate_calibrate.fit import Options, fit_wrist
from palpate_calibrate.quantities import half_widths
from palpate_calibrate.recording import Mounting, Recording, Stream
from palpate_common.rotations import log_rotation

# 95 % of the draws within: share, m, degrees, s
GOALS = {"mass": (0.006, "%", 100), "center": (0.6e-3, "mm", 1e3), "sensor_rotation": (np.radians(0.3), "deg", np.degrees(1)),
         "imu_rotation": (np.radians(0.3), "deg", np.degrees(1)), "wrench_delay": (2e-3, "ms", 1e3),
         "imu_delay": (2e-3, "ms", 1e3)}


def fit_draw(seed, cables):
    """The fit and the truth of one draw."""
    random = np.random.default_rng(seed)
    truth = simulated.draw_truth(random, float(cables))
    (pose_time, pose), (wrench_time, wrench), (imu_time, acceleration, rate) = simulated.record(
        random, truth, simulated.draw_motion(random))
    recording = Recording(f"draw {seed}", Stream("pose", pose_time, pose), Stream("wrench", wrench_time, wrench),
                          Stream("acceleration", imu_time, acceleration), Stream("rate", imu_time, rate))
    mounting = Mounting(truth.drawn_R_ES.as_matrix(), False, truth.drawn_p_ES, truth.drawn_R_EI.as_matrix(),
                        truth.drawn_p_EI)
    return fit_wrist(recording, mounting, Options()), truth


def score(seed, cables):
    """Errors and half widths of 95 % intervals by parameter, SI; the goals' errors besides."""
    fit, truth = fit_draw(seed, cables)
    p, i = fit.parameters, truth.inertia
    errors = {
        "mass": [p.mass - truth.mass],
        "moment": p.center_of_mass - truth.center,
        "inertia": p.inertia - np.array([i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]]),
        "force_bias": p.force_bias - truth.bias[:3],
        "torque_bias": p.torque_bias - truth.bias[3:],
        "sensor_rotation": log_rotation(truth.R_ES.as_matrix().T @ p.R_ES),
        "imu_rotation": log_rotation(truth.R_EI.as_matrix().T @ p.R_EI),
        "wrench_delay": [p.wrench_delay - truth.wrench_delay],
        "imu_delay": [p.imu_delay - truth.imu_delay],
    }
    goals = {"mass": abs(errors["mass"][0]) / truth.mass, "center": float(np.linalg.norm(errors["moment"]))}
    goals.update({name: float(np.linalg.norm(errors[name])) for name in GOALS if name in errors and name != "mass"})
    return {"seed": seed, "errors": {name: [float(e) for e in values] for name, values in errors.items()},
            "half_widths": {name: half_widths(fit, name).tolist() for name in errors}, "goals": goals}


def print_summary(results):
    for name, (goal, unit, factor) in GOALS.items():
        errors = factor * np.array([r["goals"][name] for r in results])
        reached = np.quantile(errors, 0.95)
        print(f"{name:<16} median {np.median(errors):.3g}, 95 % {reached:.3g}, largest {errors.max():.3g} {unit}; "
              f"goal {factor * goal:.3g}: {'met' if reached <= factor * goal else 'MISSED'}")
    pooled = []
    for name in results[0]["errors"]:
        ratio = np.abs([r["errors"][name] for r in results]) / np.array([r["half_widths"][name] for r in results])
        pooled.append(ratio)
        print(f"{name:<16} {100 * np.mean(ratio <= 1):.0f} % of the intervals hold; 95 % of the errors are within "
              f"{np.quantile(ratio, 0.95):.2f} of their half widths")
    pooled = np.hstack(pooled)
    holding, wide = float(np.mean(pooled <= 1)), 1 / float(np.quantile(pooled, 0.95))
    low, high = bootstrap(np.mean(pooled <= 1, axis=1))
    print(f"pooled: {100 * holding:.1f} % hold (goal {100 * LEAST_HOLD:.0f} %): {'met' if holding >= LEAST_HOLD else 'MISSED'}; "
          f"bootstrap interval over draws {100 * low:.1f} to {100 * high:.1f} % (goal: up to 95 % or above): "
          f"{'met' if high >= NOMINAL else 'MISSED'}")
    print(f"pooled: {wide:.2f} times as wide as needed (goal at most {TOO_WIDE:g}): {'met' if wide <= TOO_WIDE else 'MISSED'}")
