"""Evaluates an exported rig.py with arrays of one package; in a process of its own, for JAX has threads.

    python by_package.py PACKAGE FOLDER < points.json

``points.json``: states (states, n), forces (n,), parameters by name. Prints what each call gives, as lists, and under
``derivatives`` what JAX differentiates.
"""

from __future__ import annotations

import json
import sys
from importlib import import_module

package, folder = sys.argv[1:]
sys.path.insert(0, folder)
given = json.load(sys.stdin)
rig, xp = import_module("rig"), import_module(package)
if package.startswith("jax"):
    import_module("jax").config.update("jax_enable_x64", True)
states, forces = (xp.asarray(given[name], dtype=xp.float64) for name in ("states", "forces"))
found = {}
for name in ("xdot", "xdot_smooth", "output"):
    got = getattr(rig, name)(states, forces, given["parameters"], given["time"])
    assert type(got) is type(states)
    found[name] = [[float(got[i, j]) for j in range(got.shape[1])] for i in range(got.shape[0])]
if package.startswith("jax"):
    jax = import_module("jax")
    at = xp.asarray(given["at"])
    found["compiled"] = jax.jit(rig.xdot)(at, 0.5).tolist()
    found["derivatives"] = {
        "dry": float(jax.grad(lambda dry: rig.xdot(at, 0.5, {"dry": dry})[1])(0.015)),
        "state": jax.jacfwd(rig.xdot_smooth)(at, 0.5).tolist(),
    }
print(json.dumps(found))
