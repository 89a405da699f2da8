"""What the commands do, from Python, in one call each: ``dashpot.identify(...)``, ``dashpot.load(...)`` and so on.

A call (in ``commands``) does what the command of its name does, takes recordings as they are at hand (files, arrays,
data frames, SEP 5), and returns a value that prints in a few lines, shows itself in a notebook, and has what comes next
as its methods. ``dashpot`` itself has all of them by name.
"""
