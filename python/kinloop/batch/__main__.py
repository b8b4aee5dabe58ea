"""Starts kinloop batch: as python3 -m kinloop.batch, or as python3 .../batch where the compiled module is not installed."""

import sys

if not __package__:
    import importlib.util
    import pathlib

    _folder = pathlib.Path(__file__).resolve().parent
    sys.path.pop(0)  # the folder itself
    _kinloop = importlib.util.module_from_spec(importlib.util.spec_from_loader("kinloop", loader=None, is_package=True))
    _kinloop.__path__ = [str(_folder.parent)]
    sys.modules["kinloop"] = _kinloop

from kinloop.batch.command import main

sys.exit(main())
