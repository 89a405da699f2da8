"""The artefact run with the recordings: the proof that what was exported reproduces what was measured."""
