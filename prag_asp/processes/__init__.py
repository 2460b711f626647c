"""Worker processes: how they are started and limited; the memory of the machine; and progress events."""
