"""Many rigs, many tests: the manifest that names them, and the store that remembers what was done."""

from .manifest import Entry, Manifest, read_manifest

__all__ = ["Entry", "Manifest", "read_manifest"]
