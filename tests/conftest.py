"""No test reads or writes the user's cache; processes that tests start need not compile the package each time."""

import os
from pathlib import Path

os.environ["PRAG_ASP_CACHE"] = ""
if os.environ.pop("PYTHONDONTWRITEBYTECODE", None):
    os.environ["PYTHONPYCACHEPREFIX"] = str(Path(__file__).parents[1] / ".pytest_cache" / "compiled")
