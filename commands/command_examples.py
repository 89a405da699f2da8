"""An example or two of every command, which stand at the end of its ``--help``."""

from __future__ import annotations

EXAMPLES: dict[str, tuple[str, ...]] = {
    "batch": ("dashpot batch fleet.yaml -o results", "dashpot batch fleet.yaml -o results --shard 2/8"),
    "check": ("dashpot check decays.csv sweep.csv.gz", "dashpot check decay.csv --json | jq .parameters.cubic"),
    "compare": ("dashpot compare before.yaml after.yaml --repeats test1.yaml test2.yaml test3.yaml",),
    "completion": ('eval "$(dashpot completion bash)"',),
    "demo": ("dashpot demo -o demo", "dashpot demo --break quadratic-drag -o broken"),
    "diagnose": (
        "dashpot diagnose rig.yaml sweep_high.csv decay.csv --holdout multisine.csv -o diagnosis",
        "dashpot diagnose rig.yaml sweep.csv -o diagnosis --json > diagnosis.json",
    ),
    "doctor": ("dashpot doctor",),
    "export": (
        "dashpot export rig.yaml rig.fmu rig.casadi",
        "dashpot export rig.yaml rig.py rig.m rig.mo",
        "dashpot export rig.yaml rig.fmu --fmi 3 --platform linux64,win64",
    ),
    "hilbert": ("dashpot hilbert decays.csv sweep.csv.gz -o curves --figures pdf,svg",),
    "identify": (
        "dashpot identify decays.csv sweep.csv.gz -o rig.yaml --report rig.html",
        "dashpot identify decay.csv -o rig.yaml --mass 0.27 --unit mm --part 2:30",
        "dashpot identify sweep.csv.gz -o drag.yaml --with quadratic-drag --fix preload=0",
    ),
    "linearise": ("dashpot linearise rig.yaml --amplitude 1mm --step 1e-3",),
    "look": ("dashpot look runs.mat more.csv --page look.html", "dashpot look runs.mat#run3 --force '*shaker*'"),
    "paper": ("dashpot paper -o paper",),
    "plan": (
        "dashpot plan rig.yaml --want 'cubic 1%' --most-amplitude 5mm --noise 1um --force-noise 1mN",
        "dashpot plan rig.yaml --want 'friction 2%' --like sweep.csv.gz --test sweep --test random -o force.csv",
    ),
    "prove-on": (
        "dashpot prove-on rig.yaml --like sweep.csv.gz",
        "dashpot prove-on rig.yaml --noise 1um --force-noise 1mN --hide quadratic-drag",
    ),
    "show": ("dashpot show rig.yaml", "dashpot show rig.yaml --json | jq .machine.friction"),
    "simulate": ("dashpot simulate rig.yaml another.csv -o response.csv",),
    "verify": ("dashpot verify rig.fmu sweep.csv.gz another.csv --json verify.json --report verify.html",),
    "watch": ("dashpot watch january.yaml march.yaml june.yaml --report life.html",),
}


def epilog(name: str) -> str | None:
    """What stands at the end of the help of a command; None where there is no example."""
    lines = EXAMPLES.get(name)
    return None if lines is None else "\n".join(["\b", "Examples:" if len(lines) > 1 else "Example:", *lines])
