"""Pictures: counts by length, dendrograms of tasks, and maps of tasks."""
