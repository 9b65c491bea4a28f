#!/usr/bin/env python3
"""A baseline for `rundown gap-bench`: sparse regression with PySINDy on the same residuals.

    pip install pysindy
    cargo rundown gap-bench --effort with --none 0 --pairs 0 --keep --out bench
    python docs/gap-bench/pysindy_baseline.py bench [SIZE...]       # some 10 s a set

The library holds the law of each effect that a residual can show, as columns of a linear model; sections of the line are bins of 500 m. STLSQ drops columns
below a threshold of the normalised coefficients; the threshold is the one that foresees a fifth of the runs best. What is left names the effects. Limits of
traction, brakes of single runs, speed scale and lag are no terms of a residual, so no library can hold them.
"""

import json
import sys
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pysindy as ps

BIN_M = 500.0
THRESHOLDS = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2]
BEYOND = {
    "run_wind", "dragging_brake", "power_limit_section", "traction_scale", "low_adhesion", "speed_scale", "location_lag",
}


def read(folder):
    """Columns of residuals.csv; what was not recorded is 0."""
    table = np.genfromtxt(folder / "residuals.csv", delimiter=",", names=True)
    return {name: np.nan_to_num(table[name]) for name in table.dtype.names}


def library(rows, track):
    """Pairs of the effect's name and a column."""
    v = rows["speed_kmh"] / 3.6
    u, d, s = rows["effort_n_per_kg"], rows["direction"], rows["location_m"]
    one = np.ones_like(v)
    columns = [("davis_error", one), ("davis_error", v), ("davis_error", v**2), ("unknown", v**3)]
    if len(set(d)) == 2:
        columns.append(("steady_wind", d * v))
    columns += [
        ("mass_error", u),
        ("brake_fade", np.minimum(u, 0.0) * np.maximum(v - 60.0 / 3.6, 0.0)),
        ("warm_up", np.exp(-rows["since_departure_s"] / 300.0)),
        ("temperature_resistance", rows["temperature_c"] - rows["temperature_c"].mean()),
        ("seasonal_drift", rows["day"] - rows["day"].min()),
    ]
    roeckl = np.zeros_like(v)
    for curve in track.get("curve", []):
        inside = (s >= curve["from_m"]) & (s < curve["to_m"])
        roeckl += np.where(inside, 0.65 / (abs(curve["radius_m"]) - 55.0), 0.0)
    columns.append(("curve_resistance", roeckl))
    for begin in np.arange(s.min(), s.max(), BIN_M):
        inside = ((s >= begin) & (s < begin + BIN_M)).astype(float)
        columns += [("tunnel_drag", inside * v**2), ("gradient_error", inside * d), ("unknown", inside)]
    spread = [(name, c, np.sqrt(np.mean(c**2))) for name, c in columns]
    return [(name, c / size) for name, c, size in spread if size > 0.0]


def fit(x, y, threshold):
    """Coefficients of the columns that are left."""
    model = ps.SINDy(optimizer=ps.STLSQ(threshold=threshold, alpha=1.0), feature_library=ps.IdentityLibrary())
    model.fit(x, t=1.0, x_dot=y.reshape(-1, 1))
    return model.coefficients()[0]


def named(folder):
    """The names that the regression leaves."""
    rows = read(folder)
    with open(folder / "track.toml", "rb") as file:
        columns = library(rows, tomllib.load(file))
    x = np.column_stack([c for _, c in columns])
    scale = rows["residual_n_per_kg"].std()
    y = rows["residual_n_per_kg"] / scale
    held_out = rows["run"] % 5 == 0

    def error(threshold):
        beta = fit(x[~held_out], y[~held_out], threshold)
        return np.mean((y[held_out] - x[held_out] @ beta) ** 2)

    beta = fit(x, y, min(THRESHOLDS, key=error))
    return sorted({name for (name, _), b in zip(columns, beta) if b != 0.0})


def main():
    # A threshold that leaves nothing is an answer, no fault.
    warnings.filterwarnings("ignore", message="Sparsity parameter is too big")
    bench, sizes = Path(sys.argv[1]), sys.argv[2:]
    sets = json.loads((bench / "sets.json").read_text())
    shares = {}
    for one in sets:
        folder = bench / "sets" / str(one["ask"]["seed"])
        key = one["score"]["key"]
        if not key or (sizes and one["ask"]["size"] not in sizes) or not (folder / "residuals.csv").exists():
            continue
        found = named(folder)
        print(one["ask"]["size"], "+".join(key), "->", " + ".join(found) or "nothing", flush=True)
        inside = not BEYOND & set(key)
        for group in ["all kinds"] + ["kinds that a residual shows"] * inside:
            shares.setdefault((group, one["ask"]["size"]), []).append((found == key, one["score"]["exact"]))
    for (group, size), right in shares.items():
        theirs, ours = (sum(r[i] for r in right) for i in (0, 1))
        print(f"{group}, {size}: PySINDy {theirs}/{len(right)}, rundown gap {ours}/{len(right)}")


main()
