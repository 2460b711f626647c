"""Read the table ``[scene]`` of a domain.toml."""
