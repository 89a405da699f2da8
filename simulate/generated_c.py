"""The C that CasADi generates, whole: CasADi writes it to a file, and says nothing where the disk is full."""

from __future__ import annotations

import tempfile
from pathlib import Path

from ..errors import Unwritable
from ..model.law import Expression


def generated_c(generator: Expression) -> str:
    """What a ``casadi.CodeGenerator`` of the name ``law.c`` writes.

    Raises:
        Unwritable: where the temporary folder does not take all of it.
    """
    with tempfile.TemporaryDirectory() as folder:
        try:
            generator.generate(folder + "/")
            text = (Path(folder) / "law.c").read_text(encoding="utf-8")
        except (OSError, RuntimeError, UnicodeDecodeError):
            text = ""
    whole = generator.dump()  # the same without the words above and below
    if whole not in text or not text.endswith('#ifdef __cplusplus\n} /* extern "C" */\n#endif\n'):
        raise Unwritable(
            f"{tempfile.gettempdir()}: does not take the C code of the model; make room there, or set TMPDIR to "
            "another folder"
        )
    return text
