"""The tables of a dataset, whose columns and types are the same for every domain.

No mapping has entities or fluents as keys, because the type of the column would then depend on the domain; instead, the
facts of a state are a list of {fluent, value}.
"""

from __future__ import annotations

from collections.abc import Mapping

import pyarrow as pa

FACTS = pa.list_(pa.struct([("fluent", pa.string()), ("value", pa.bool_())]))
"""The known facts of a state."""

BUDGET = pa.struct([("restarts", pa.int64()), ("samples", pa.int64()), ("tier", pa.string())])
CAUSES = pa.list_(pa.struct([("cause", pa.string()), ("count", pa.int64())]))
DETAILS = pa.list_(
    pa.struct(
        [
            ("cause", pa.string()),
            ("text", pa.string()),
            ("fact", pa.string()),
            ("value", pa.bool_()),
            ("entities", pa.list_(pa.string())),
            ("attempts", pa.int64()),
        ]
    )
)
VERDICT = pa.struct(
    [
        ("status", pa.string()),
        ("budget", BUDGET),
        ("seed", pa.int64()),
        ("index", pa.int64()),
        ("reason", pa.string()),
        ("causes", CAUSES),
        ("restarts", pa.int64()),
        ("details", DETAILS),
    ]
)
"""The verdict of physics; null if physics was not run."""

_OF_A_TASK = [
    ("draw", pa.int64()),
    ("domain", pa.string()),
    ("length", pa.int32()),
    ("rank", pa.string()),
    ("log_probability", pa.float64()),
    ("plan", pa.list_(pa.string())),
    ("skeleton", pa.list_(pa.string())),
    ("entities", pa.list_(pa.struct([("entity", pa.string()), ("class", pa.string())]))),
    ("initial", FACTS),
    ("states", pa.list_(FACTS)),
    ("subgoals", pa.list_(FACTS)),
    ("goal", FACTS),
    ("instruction", pa.list_(pa.struct([("level", pa.string()), ("text", pa.string())]))),
    ("subgoal_instructions", pa.list_(pa.string())),
    ("named", pa.list_(pa.string())),
    ("verdict", VERDICT),
]

SCHEMAS: Mapping[str, pa.Schema] = {
    "tasks": pa.schema([("task", pa.int64()), *_OF_A_TASK, ("starts", pa.int32())]),
    "rejected": pa.schema(_OF_A_TASK),
    "witnesses": pa.schema(
        [("task", pa.int64()), ("start", pa.int32()), ("index", pa.int64()), ("witness", pa.string())]
    ),
    "recordings": pa.schema(
        [
            ("task", pa.int64()),
            ("start", pa.int32()),
            ("file", pa.string()),
            ("sha256", pa.string()),
            ("frames", pa.int64()),
            ("seconds", pa.float64()),
            ("ends", pa.list_(pa.int64())),
        ]
    ),
}
"""The schema of each table."""

ROW_GROUP: Mapping[str, int] = {"tasks": 256, "rejected": 256, "witnesses": 64, "recordings": 1024}
"""The number of rows in a row group of each table, the smallest unit that can be read."""
