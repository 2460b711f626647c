"""Check tables in TOML or JSON, and report each problem with its file, line, key and remedy."""
