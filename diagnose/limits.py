"""The numbers that decide in diagnose/, each with its unit, what it decides, and why."""

from __future__ import annotations

from ..identify.signals.registry import decides, numerics

# experiment/excitations.py

BEYOND = decides(
    1.5,
    "times what was recorded",
    "how far beyond the recordings an experiment may go",
    why="half as much again is what a rig that was driven so far is likely to bear",
)
CYCLES = numerics(
    90.0,
    "natural cycles",
    why="how long a proposed experiment is: enough to pass a resonance slowly beside its own decay",
)
DRIVE_LEVELS = numerics(
    (0.15, 0.4, 1.0, BEYOND),
    "parts of the largest recorded",
    why="force in rehearsals: a decade in steps that a nonlinearity of third order tells apart",
)
RELEASE_LEVELS = numerics(
    (0.3, 0.6, 1.0, BEYOND),
    "parts of the largest recorded",
    why="displacement of releases in rehearsals: a release passes all lower levels by itself, so the steps are smaller",
)

# experiment/next_experiment.py

WORTHWHILE = decides(
    0.7,
    "part of what there was",
    "to what an experiment must bring an error, and what a difference beyond the recorded is worth",
    why="a third less is worth a recording or a risk; a tenth less is not",
)
POORLY_KNOWN = decides(
    0.1,
    "part of the value",
    "from which error on a parameter is poorly known",
    why="a tenth: fewer than two digits of it are known",
)

# family.py

OTHER_FREQUENCY = decides(
    1.3,
    "times",
    "by how much the natural frequency must be off for the recordings to be of another rig",
    why="physical limit: what is left out (a spring that softens) bends a fitted frequency by a few per cent",
)
OTHER_MASS = decides(
    2.0,
    "times",
    "the same of the mass",
    why="physical limit: what is left out (mass that moves along) bends a fitted mass by some ten per cent",
)

# place/equation_error.py

BLOCK_CYCLES = decides(
    4.0,
    "cycles",
    "what counts as one independent piece of evidence of where something is missing",
    why="longer than the memory of the smoother and of the resonance",
)

# place/locate.py

LEAST_EVIDENCE = decides(
    0.015,
    "log-likelihood a sample",
    "what a missing force must gain to be placed",
    why="3 % of the power of the noise, which is known no better",
)

# place/mismatch_ranges.py

NOTABLE = decides(
    0.05,
    "part of the largest excess",
    "that a range must show to be reported",
    why="a twentieth of the largest is not where an engineer would look",
)
NOISE_DOUBT = decides(
    0.2, "part of its power", "to which the noise is known", why="its level is good to a tenth, twice in power"
)
LINE_CYCLES = decides(
    80.0,
    "cycles",
    "how long a recording must be to be asked for a line",
    why="shorter ones have fewer bins than a line and what is around it need",
)
STEADY = decides(
    0.5,
    "part of its size",
    "by how much less a force from outside may show in one recording than in another",
    why="it has one size; recordings cut and fade it by less",
)

# place/recorded_ranges.py

LARGE_PART = decides(
    0.1,
    "part of the largest amplitude",
    "above which free motion has a frequency",
    why="below a tenth the end of a decay is as loud as its noise",
)

# place/smoother.py

LASTING_SIGN = decides(
    0.1,
    "of a cycle",
    "after which a sign that noise hides is another one",
    why="noise changes a sign from sample to sample, the motion once in half a cycle",
)

# place/what_it_follows.py

GENERALITY = decides(
    {"displacement and velocity": 0.8, "memory": 1.0},
    "part of what is explained",
    "how much of what a general kind explains counts",
    why="a memory imitates a function of displacement and velocity with fewer terms",
)
PLAINER = decides(
    0.9,
    "part of what is explained",
    "up to which a plainer kind is preferred",
    why="a tenth more is what further freedom explains of noise",
)
TELLING = decides(
    0.35,
    "part of the excess",
    "that a kind must explain to have found it",
    why="a third: what follows another coordinate explains less by the part that both share",
)
FAINT = decides(
    0.12, "part of the excess", "that it must explain otherwise", why="an eighth, where it alone explains anything"
)
AHEAD = decides(
    1.4,
    "times",
    "by how much more than any unrelated kind it must then explain",
    why="half as much again is beyond what the kinds share",
)
LOCKED = decides(
    0.4,
    "part of the power",
    "that must be in step with the motion for the motion to make the force",
    why="less is a force from outside",
)

# recordings.py

THIRDS = decides(
    3,
    "stretches",
    "of how many stretches one is held out or foretold",
    why="large, middle and small motion are then on both sides",
)
MEMORIES = decides(
    3.0,
    "time constants of the decay",
    "how long a driven stretch is at least",
    why="what its rig remembers of the stretch before has fallen by exp(-3)",
)
LEAST_DAMPING = decides(
    1e-3,
    "part of the critical",
    "the least damping by which that length is reckoned",
    why="physical limit: structures have more; with less a stretch would be as long as the recording",
)

# repair_trial.py

COMPUTED = decides(
    0.5,
    "part of the noise",
    "below which what is left shows that a record was computed",
    why="what a model leaves of a measured record is its noise at least, and that is known to a tenth",
)

# search/by_prediction.py

PROBE_MEMORY = decides(
    1.0 / 8.0,
    "cycles",
    "over which probes of a law with side valleys are predicted",
    why=("a step below the memory at which other starts begin: each bounce is forgotten before it is carried far"),
)

# search/judgement.py

MATTERS = decides(
    0.01,
    "part of the power left",
    "that a law must take away to matter",
    why=(
        "physical limit: a tenth of its size. No simulation is exact, and a longer record makes ever smaller "
        "parts significant that no engineer asks for"
    ),
)
GROUP = decides(
    0.95,
    "of the odds",
    "which set of laws cannot be distinguished, and what is beyond chance far from the noise",
    why="odds: the smallest set that holds this share, the usual credible set",
)

LISTED = decides(
    3.0,
    "odds",
    "that what leaves a mismatch is of the library, or one of those in its group",
    why=(
        "odds: of 33 names far from the noise 25 were there, whatever share they took "
        "(dirty rigs, seeds 7001, 7002, 7701, 9109, 9110; 28 Nov 2026)"
    ),
)

# search/measure.py

NEAR = decides(
    1.2,
    "times the noise",
    "what is near the noise without further proof",
    why=(
        "physical limit: the levels of sensor and force noise, each good to a tenth, enter it together; beyond, "
        "it has to be shown that it is noise at all"
    ),
)

# search/race.py

LEAST_CREDIT = decides(
    0.1, "part of what it promises", "that a start is believed at least", why="a valley may open after a bend"
)

# search/residual_test.py

FAR_ABOVE_NOISE = decides(
    10.0,
    "times the noise",
    "what is a mismatch where a segment is too short to see whether it moves with the rig",
    why=(
        "physical limit: a hundred times the power that the highest frequencies have is more than the colour of "
        "the noise of sensors"
    ),
)
BURST = decides(
    30.0,
    "times the median power",
    "what a window must have to be a burst",
    why=(
        "error rate: noise of two degrees of freedom a window gets there once in 1e9 windows, of a single one in 5000"
    ),
)
FEWEST_WINDOWS = decides(
    6,
    "windows",
    "of how many a segment is long enough for a rank correlation",
    why="a rank correlation of fewer says nothing",
)
IN_STEP = decides(
    0.05,
    "part of the power",
    "what keeps step with the motion or rings with the rig",
    why="physical limit: a fifth of the size",
)
BEYOND_CHANCE = decides(
    8.0,
    "standard deviations",
    "how far it must lie above what noise of the same spectrum has",
    why=(
        "error rate: whatever that spectrum, fewer than one in 2000 get there (one degree of freedom: a "
        "chi-square of 12.3)"
    ),
)
UNTOLD = decides(
    0.5, "part of the power", "from which share by chance on keeping step tells nothing", why="odds: as likely as not"
)

# search/score_test.py

LEAST_STEP = decides(
    0.05,
    "part of the full step, or its inverse",
    "which length of a step is believed",
    why="beyond a factor of twenty the linearised response says nothing",
)

# search/search.py

MOST_EFFECTS = decides(
    3,
    "laws",
    "how many are named at most",
    why="physical limit: more missing at once are not distinguished by any recording that we know of",
)

# search/weigh.py

STRETCH_CYCLES = decides(
    2.0,
    "cycles",
    "how long a stretch is at least that is foretold from the others",
    why="one tells its initial state, and the next one is foretold",
)

# simplify.py

ALIKE = decides(
    0.01, "part of the noise", "by how much motions differ that are alike", why="physical limit: no sensor shows it"
)

# place/mismatch_ranges.py and place/statement.py: what a sentence needs

SAMPLES_A_RANGE = decides(
    3, "samples a range", "of how many on average a range is formed", why="fewer leave most of the ranges empty"
)
FEWEST_IN_RANGE = decides(
    10, "samples", "of how many a range has an excess", why="a mean of fewer has no error to hold it against"
)
NARROW = decides(
    0.2, "of its power", "what a line may have beside it", why="a resonance or the passage of a sweep has more"
)
ALL_AMPLITUDES = decides(
    0.8, "of the largest", "how wide a range of amplitudes is all of them", why="its ends hold few samples"
)
