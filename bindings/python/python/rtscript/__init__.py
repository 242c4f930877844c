"""Pictures written as code: scenes as Rhai scripts, rendered to the same bits on every machine.

>>> import rtscript
>>> image = rtscript.render("light([5, 5, 5], [1, 1, 1]); diffuse(0.9, 0.3, 0.2); sphere(0, 0, 0, 1);", size=(64, 48))
>>> image.width, image.height
(64, 48)
"""

from __future__ import annotations

import os
from typing import Callable, Dict, Mapping, Optional, Tuple, Union

from ._errors import Diagnostic, Error
from ._rtscript import Image, Run, Script, __version__

__all__ = ["Diagnostic", "Error", "Image", "Run", "Script", "__version__", "render"]


def render(
    text: str,
    *,
    name: str = "scene.rhai",
    limits: str = "default",
    parameters: Optional[Mapping[str, Union[bool, int, float, str]]] = None,
    size: Optional[Tuple[int, int]] = None,
    samples: Optional[int] = None,
    seed: Optional[int] = None,
    folder: Union[str, "os.PathLike[str]", None] = None,
    files: Optional[Dict[str, bytes]] = None,
    print: Optional[Callable[[str], object]] = None,
    progress: Optional[Callable[[int, int], object]] = None,
    threads: int = 0,
) -> Image:
    """Reads, runs and renders a script: ``Script(text).run(...).render(...)`` in one call.

    The image has the warnings of all three. See :class:`Script`, :meth:`Script.run` and :meth:`Run.render`.
    """
    run = Script(text, name=name, limits=limits).run(
        parameters,
        size=size,
        samples=samples,
        seed=seed,
        folder=folder,
        files=files,
        print=print,
        progress=progress,
        threads=threads,
    )
    return run.render(progress=progress, threads=threads)
