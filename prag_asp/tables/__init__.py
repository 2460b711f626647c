"""Check the tables that authors write, in TOML or JSON: every problem with its file, line and key, and what to do."""
