"""No test reads or writes the user's cache."""

import os

os.environ["PRAG_ASP_CACHE"] = ""
